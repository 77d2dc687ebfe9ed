// Programs that other processes compile before they are asked for, and what is left to do where
// those processes do nothing, or harm.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <impactdic/error.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>
#include <utility>

#include "host/base/process/helper_program.h"
#include "host/opencl/arguments.h"
#include "host/opencl/buffer.h"
#include "host/opencl/engine.h"
#include "tests/support/engine.h"
#include "tests/support/scratch.h"

namespace impactdic {
namespace {

namespace fs = std::filesystem;

// Of the small programs: what takes PoCL least.
std::vector<opencl::ProgramRequest> two_programs() {
  return {{"frames/unpack.cl", {{"PIXEL", "uchar"}}}, {"frames/unpack.cl", {{"PIXEL", "ushort"}}}};
}

class CompileAhead : public ::testing::Test {
 protected:
  // An engine that expects both programs and has `program` ("": the installed one) compile them.
  std::unique_ptr<opencl::Engine> engine(const std::string& program, int compilers = 2) {
    opencl::EngineOptions options;
    options.cache_dir = cache();
    options.compilers = compilers;
    options.compiler_program = program;
    options.expects = [this](const opencl::Engine& unopened) {
      told_ = unopened.device().name;
      return two_programs();
    };
    const int device = testing::shared_engine().device().index;
    return std::make_unique<opencl::Engine>(std::to_string(device), options);
  }
  std::string cache() const { return (fs::path(folder_.string()) / "cache").string(); }
  // Whether so many entries are there within seconds.
  bool has_entries(std::size_t count) const {
    for (int i = 0; i < 1000; ++i) {
      std::size_t found = 0;
      std::error_code none_yet;
      for (const auto& entry : fs::directory_iterator(cache(), none_yet)) {
        found += entry.path().extension() == ".clbin" ? 1 : 0;
      }
      if (found >= count) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }
  // A program for the shell.
  std::string script(const std::string& text) const {
    const fs::path path = fs::path(folder_.string()) / "helper";
    std::ofstream(path) << "#!/bin/sh\n" << text << "\n";
    fs::permissions(path, fs::perms::owner_all);
    return path.string();
  }
  // Both programs do what they should.
  static void expect_works(opencl::Engine& engine) {
    cl::Kernel kernel = engine.kernel(two_programs()[0], "unpack");
    auto pixels = opencl::make_buffer<unsigned char>(engine, std::vector<unsigned char>(64, 7));
    const opencl::Buffer<float> image(engine, 64);
    const opencl::Buffer<unsigned char> kept(engine, 64);
    opencl::set_arguments(kernel, pixels.get(), image.get(), kept.get(), cl_ulong{64}, cl_ulong{0});
    engine.launch(engine.queue(), kernel, cl::NDRange(64), cl::NDRange(64));
    std::vector<float> levels(64);
    image.read(engine, levels);
    EXPECT_EQ(levels, std::vector<float>(64, 7.0F));
    EXPECT_NO_THROW(engine.kernel(two_programs()[1], "unpack"));
  }
  static bool has_children() { return ::waitpid(-1, nullptr, WNOHANG) >= 0; }
  // Nobody is left behind, running or unlooked for.
  static bool all_have_ended() {
    for (int i = 0; i < 500 && has_children(); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return !has_children();
  }

  testing::ScratchFolder folder_;
  std::string told_;
};

TEST_F(CompileAhead, ProgramsAreThereBeforeTheyAreAskedFor) {
  ASSERT_NE(helper_program("impactdic-compile"), "");
  const auto waits = engine("");
  EXPECT_EQ(told_, waits->device().name);
  EXPECT_TRUE(has_entries(2));
  expect_works(*waits);
  EXPECT_TRUE(all_have_ended());
  // What is there is not compiled again.
  const auto knows = engine("/bin/false");
  expect_works(*knows);
}

TEST_F(CompileAhead, WhoDoesNothingIsDoneWithout) {
  for (const char* useless : {"/bin/true", "/no/such/program", "/dev/null"}) {
    fs::remove_all(cache());
    expect_works(*engine(useless));
    EXPECT_TRUE(all_have_ended()) << useless;
  }
}

TEST_F(CompileAhead, WhoIsKilledIsDoneWithout) {
  expect_works(*engine(script("kill -9 $$")));
  EXPECT_TRUE(all_have_ended());
}

// $2 is the cache. Entries that are none are seen to be none.
TEST_F(CompileAhead, RubbishInTheCacheIsNotBelieved) {
  expect_works(*engine(""));  // for the names of the entries
  ASSERT_TRUE(has_entries(2));
  const std::string lists = "ls \"" + cache() + "\" > \"" + folder_.string() + "/names\"";
  ASSERT_EQ(std::system(lists.c_str()), 0);
  fs::remove_all(cache());
  expect_works(*engine(script("while read name; do echo rubbish > \"$2/$name\"; done < \"" +
                              folder_.string() + "/names\"")));
}

// Nobody is waited for that nobody needs: neither a run that ends, nor one whose helper hangs.
TEST_F(CompileAhead, WhoHangsEndsWithTheEngine) {
  const auto began = std::chrono::steady_clock::now();
  engine(script("exec sleep 100"));
  EXPECT_TRUE(all_have_ended());
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(20));
}

// A process whose caller is killed ends by itself.
TEST_F(CompileAhead, NobodyOutlivesItsCaller) {
  int alive[2], none[2];
  ASSERT_EQ(::pipe(alive), 0);
  ASSERT_EQ(::pipe(none), 0);                                    // a turn that never comes
  for (int* end : {&alive[0], &alive[1], &none[0], &none[1]}) {  // not among those that it is given
    const int low = std::exchange(*end, ::fcntl(*end, F_DUPFD, 50));
    ::close(low);
  }
  const std::string program = helper_program("impactdic-compile");
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(alive[0], STDIN_FILENO);
    ::dup2(none[0], opencl::kAheadTurn);
    ::execl(program.c_str(), program.c_str(), "0", cache().c_str(), "", "binaries", "0", nullptr);
    ::_exit(EXIT_SUCCESS);
  }
  int status = 0;
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(::waitpid(child, &status, WNOHANG), 0) << "it waits for its turn";
  ::close(alive[1]);
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == EXIT_FAILURE);
  for (const int end : {alive[0], none[0], none[1]}) ::close(end);
}

TEST_F(CompileAhead, WithoutACacheNobodyIsStarted) {
  std::ofstream(cache()) << "a file";
  expect_works(*engine(script("touch \"" + folder_.string() + "/started\"")));
  EXPECT_FALSE(fs::exists(fs::path(folder_.string()) / "started"));
}

TEST_F(CompileAhead, NoneAreAskedForByTheEnvironment) {
  opencl::EngineOptions options;
  options.cache_dir = cache();
  for (const char* wrong : {"many", "-1", "65", ""}) {  // also where nothing is expected
    ::setenv("IMPACTDIC_COMPILERS", wrong, 1);
    EXPECT_THROW(opencl::Engine("auto", options), InvalidArgument) << wrong;
  }
  options.expects = [](const opencl::Engine&) { return two_programs(); };
  ::setenv("IMPACTDIC_COMPILERS", "0", 1);
  expect_works(*std::make_unique<opencl::Engine>("auto", options));
  ::unsetenv("IMPACTDIC_COMPILERS");
}

}  // namespace
}  // namespace impactdic
