// `bench` and `tune`: the table, its JSON, what is kept, and errors.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace impactdic::testing {
namespace {

nlohmann::json json_of(const std::filesystem::path& file) {
  return nlohmann::json::parse(read_text(file));
}

TEST(BenchCommand, WritesSpeedAndErrorOfTheRowsAskedFor) {
  const ScratchFolder folder;
  const auto file = folder / "bench.json";
  const Outcome run =
      run_program("bench --device cpu --only 'equal 32x32' --seconds 0.01 --json " + quoted(file));
  ASSERT_EQ(run.status, 0) << run.err;
  const nlohmann::json all = json_of(file);
  EXPECT_FALSE(all["device"]["name"].get<std::string>().empty());
  EXPECT_EQ(all["device"]["count"], 1);
  EXPECT_GT(all["copy_bytes_per_s"], 1e8);
  EXPECT_GT(all["flops_per_s"], 1e8);
  // Single pairs, a clip, a stream of frames, and FFTW where it is there.
  ASSERT_GE(all["rows"].size(), 3U);
  for (const nlohmann::json& row : all["rows"]) {
    const auto work = row["work"].get<std::string>();
    SCOPED_TRACE(work + ", " + row["variant"].get<std::string>());
    EXPECT_NE(work.find("equal 32x32"), std::string::npos);
    EXPECT_NE(run.out.find(work), std::string::npos);
    EXPECT_GE(row["runs"], 3);
    EXPECT_NEAR(row["per_second"].get<double>(),
                row["units_per_run"].get<double>() / row["median_s"].get<double>(),
                1e-6 * row["per_second"].get<double>());
    EXPECT_LE(row["least_s"], row["median_s"]);
    // Windows of 32 px whose pixels leave by up to a fifth.
    EXPECT_GT(row["rms_error_px"], 0.01);
    EXPECT_LT(row["rms_error_px"], 0.3);
    EXPECT_LT(row["lost"], 0.01);
  }
}

TEST(BenchCommand, SaysWhatIsWrong) {
  const Outcome unknown = run_program("bench --device cpu --only nothing --seconds 0.01");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("--only"), std::string::npos) << unknown.err;
  EXPECT_EQ(run_program("bench --seconds 0").status, 2);
  EXPECT_EQ(run_program("bench --batch -1").status, 2);
  const ScratchFolder folder;
  const Outcome lost = run_program("bench --device cpu --only 'stream' --seconds 0.01 --json " +
                                   quoted(folder / "none" / "bench.json"));
  EXPECT_EQ(lost.status, 1);
  EXPECT_NE(lost.err.find("bench.json"), std::string::npos) << lost.err;
}

TEST(TuneCommand, KeepsTheQuickestRightVariant) {
  const ScratchFolder folder;
  ASSERT_EQ(setenv("IMPACTDIC_CACHE_DIR", (folder / "cache").c_str(), 1), 0);
  const Outcome run = run_program("tune --device cpu --window 9 --search 3 --seconds 0.01");
  ASSERT_EQ(run.status, 0) << run.err;
  const auto file = folder / "cache" / "tuning.json";
  EXPECT_NE(run.out.find(file.string()), std::string::npos) << run.out;
  const nlohmann::json rows = json_of(file)["kernels"];
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0]["work"], "zncc 9 in 15");
  EXPECT_GT(rows[0]["per_second"], 0);
  EXPECT_LT(rows[0]["difference_px"], 1e-4);
  EXPECT_NE(run.out.find("zncc 9 in 15: " + rows[0]["variant"].get<std::string>()),
            std::string::npos)
      << run.out;
  // Tuned again, the row takes the place of the old one; rows of other work stay.
  nlohmann::json kept = json_of(file);
  kept["kernels"].push_back(rows[0]);
  kept["kernels"][1]["work"] = "zncc 8 in 14";
  std::ofstream(file) << kept;
  const Outcome again = run_program("tune --device cpu --window 9 --search 3 --seconds 0.01");
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(json_of(file)["kernels"].size(), 2U);
  // Where nothing can be kept, that is an error.
  std::ofstream(folder / "file") << "no folder";
  setenv("IMPACTDIC_CACHE_DIR", (folder / "file" / "cache").c_str(), 1);
  const Outcome lost = run_program("tune --device cpu --window 9 --search 3 --seconds 0.01");
  unsetenv("IMPACTDIC_CACHE_DIR");
  EXPECT_EQ(lost.status, 1);
  EXPECT_NE(lost.err.find("file/cache"), std::string::npos) << lost.err;
}

TEST(TuneCommand, RefusesSizesThatNoMethodHas) {
  EXPECT_EQ(run_program("tune --device cpu --window 1 --seconds 0.01").status, 2);
  EXPECT_EQ(run_program("tune --device cpu --window 15 --search -1 --seconds 0.01").status, 2);
  EXPECT_EQ(run_program("tune --seconds -1").status, 2);
}

}  // namespace
}  // namespace impactdic::testing
