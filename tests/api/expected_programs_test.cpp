// The programs that a track is expected to need, which other processes compile ahead, are those
// that it asks for.
#include "host/motion/expected_programs.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <set>

#include "tests/support/program.h"

namespace impactdic::testing {
namespace {

namespace fs = std::filesystem;

// File and options of a program, as the cache's entry of it (its key: four lines about the device,
// the options, the source) and as somebody who expects it says them.
std::set<std::string> programs_in(const fs::path& cache) {
  std::set<std::string> programs;
  for (const auto& entry : fs::directory_iterator(cache)) {
    std::ifstream file(entry.path());
    std::string options, source;
    for (int i = 0; i < 5; ++i) std::getline(file, options);
    std::getline(file, source);
    programs.insert(source.substr(source.find('"')) + options);
  }
  return programs;
}
std::set<std::string> expected(bool sure) {
  const ScratchFolder cache;
  std::set<std::string> programs;
  opencl::EngineOptions options;
  options.cache_dir = cache.string();
  options.compilers = 1;
  options.compiler_program = "/bin/true";
  options.expects = [&](const opencl::Engine& engine) {
    motion::EstimatorOptions estimator;
    estimator.estimator = Estimator::kBall;
    estimator.field.window_px = 17;
    const auto all = motion::expected_programs(engine, estimator, {PixelType::kU8, 10, true});
    for (const opencl::ProgramRequest& program : all) {
      if (program.is_sure != sure) continue;
      std::string text = "\"kernels/" + program.file + "\"-cl-std=CL1.2";
      for (const auto& [name, value] : program.defines) text += " -D" + name + "=" + value;
      programs.insert(text + (program.options.empty() ? "" : " ") + program.options);
    }
    return all;
  };
  const opencl::Engine engine("auto", options);
  return programs;
}

// What a track compiles is what it is expected to, but for what takes no time.
TEST(ExpectedPrograms, ATrackAsksForTheProgramsThatAreExpected) {
  const ScratchFolder folder, cache;
  ASSERT_EQ(run_program("synth --size 160x160 --radius-px 40 --frames 10 --velocity-px 1,0.5 "
                        "--rotation-deg 2 --noise 3 --seed 5 -o " +
                        quoted(folder / "clip"))
                .status,
            0);
  const std::string command =
      " --fps 10000 --ball-diameter-mm 67 --window 17 -q -o " + quoted(folder / "out");
  const char* const usual = std::getenv("IMPACTDIC_CACHE_DIR");
  const std::string before = usual == nullptr ? "" : usual;
  ::setenv("IMPACTDIC_CACHE_DIR", cache.string().c_str(), 1);
  const Outcome run = run_program("track " + quoted(folder / "clip/video.tif") + command);
  if (usual == nullptr) {
    ::unsetenv("IMPACTDIC_CACHE_DIR");
  } else {
    ::setenv("IMPACTDIC_CACHE_DIR", before.c_str(), 1);
  }
  ASSERT_EQ(run.status, 0) << run.err;
  std::set<std::string> asked = programs_in(cache.string());
  EXPECT_EQ(asked.erase("\"kernels/frames/unpack.cl\"-cl-std=CL1.2 -DPIXEL=uchar"), 1U);
  EXPECT_EQ(asked, expected(true));
  EXPECT_EQ(expected(false).size(), 4U);
}

}  // namespace
}  // namespace impactdic::testing
