// `batch` by several processes: shards, the table that joins them, and what is refused.
#include <gtest/gtest.h>

#include <fstream>
#include <utility>

#include "tests/support/program.h"

namespace impactdic::testing {
namespace {

namespace fs = std::filesystem;

class Clips {
 public:
  static constexpr int kShots = 5;
  Clips() {
    fs::create_directories(folder_ / "clips");
    for (int i = 1; i < kShots; ++i) {
      const std::string name = "shot_" + std::to_string(i);
      const Outcome made = run_program(
          "synth --pattern e1 --size 128x128 --radius-px 36 --frames 4 --velocity-px 1,0.5 -o " +
          quoted(folder_ / name) + " --seed " + std::to_string(i));
      if (made.status != 0) throw std::runtime_error(made.err);
      fs::rename(folder_ / name / "video.tif", folder_ / "clips" / (name + ".tif"));
    }
    std::ofstream(folder_ / "clips" / "shot_9.cine") << "this is no clip";
  }
  fs::path path(const std::string& name) const { return folder_ / name; }
  Outcome batch(const std::string& out, const std::string& options) const {
    return run_program("batch " + quoted(folder_ / "clips") + " -o " + quoted(folder_ / out) +
                       " --fps 10000 --ball-diameter-mm 67 " + options);
  }

 private:
  ScratchFolder folder_;
};

const Clips& clips() {
  static const Clips made;
  return made;
}

const std::string& table_of_one_process() {
  static const std::string table = [] {
    const Outcome one = clips().batch("one", "");
    if (one.status != 0) throw std::runtime_error(one.err);
    return read_text(clips().path("one/shots.csv"));
  }();
  return table;
}

TEST(Share, TheLastShardJoinsAll) {
  const std::pair<const char*, const char*> parts[] = {
      {"2/3", "1 shots measured by this process, 1 failed"},
      {"1/3", "2 shots measured by this process, 0 failed"}};
  for (const auto& [shard, said] : parts) {
    const Outcome part = clips().batch("shards", std::string("--shard ") + shard);
    ASSERT_EQ(part.status, 0) << part.err;
    EXPECT_NE(part.out.find(said), std::string::npos) << part.out;
    EXPECT_FALSE(fs::exists(clips().path("shards/shots.csv")));
  }
  const Outcome last = clips().batch("shards", "--shard 3/3");
  ASSERT_EQ(last.status, 0) << last.err;
  EXPECT_NE(last.out.find("4 of 5 shots measured; table in"), std::string::npos) << last.out;
  EXPECT_EQ(read_text(clips().path("shards/shots.csv")), table_of_one_process());
  for (int i = 1; i < Clips::kShots; ++i) {
    const std::string table = "/shots/shot_" + std::to_string(i) + "/track.csv";
    EXPECT_EQ(read_text(clips().path("shards" + table)), read_text(clips().path("one" + table)));
  }
  // Once more is no more work.
  const auto written = fs::last_write_time(clips().path("shards/shots/shot_1/track.csv"));
  EXPECT_EQ(clips().batch("shards", "--shard 1/3").status, 0);
  EXPECT_EQ(fs::last_write_time(clips().path("shards/shots/shot_1/track.csv")), written);
}

TEST(Share, JoinListsWhatIsMissing) {
  ASSERT_EQ(clips().batch("partly", "--shard 1/2").status, 0);
  const Outcome joined = clips().batch("partly", "--join");
  EXPECT_EQ(joined.status, 1);
  EXPECT_NE(joined.err.find("error: 2 of 5 shots are missing"), std::string::npos) << joined.err;
  const CsvTable table(clips().path("partly/shots.csv"));
  const std::vector<std::string> expected = {"ok", "missing", "ok", "missing", "failed"};
  EXPECT_EQ(table.text("status"), expected);
  EXPECT_EQ(table.text("reason")[1], "no process has measured it");
  ASSERT_EQ(clips().batch("partly", "--shard 2/2").status, 0);
  EXPECT_EQ(read_text(clips().path("partly/shots.csv")), table_of_one_process());
  EXPECT_EQ(clips().batch("partly", "--join").status, 0);
}

TEST(Share, ProcessesThatAreGivenTheSameNameShare) {
  const Outcome one = clips().batch("named", "--share night");
  ASSERT_EQ(one.status, 0) << one.err;
  EXPECT_EQ(read_text(clips().path("named/shots.csv")), table_of_one_process());
  const Outcome other = clips().batch("named", "--share night --surface-angle-deg 3");
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.err.find("another job"), std::string::npos) << other.err;
  // A new run does not write over the results of an earlier one, unless it is to go on with them.
  EXPECT_EQ(clips().batch("named", "--share morning").status, 2);
  const auto written = fs::last_write_time(clips().path("named/shots/shot_1/track.csv"));
  EXPECT_EQ(clips().batch("named", "--share noon --resume").status, 0);
  EXPECT_EQ(fs::last_write_time(clips().path("named/shots/shot_1/track.csv")), written);
  EXPECT_EQ(clips().batch("named", "--share evening --force").status, 0);
  EXPECT_NE(fs::last_write_time(clips().path("named/shots/shot_1/track.csv")), written);
  EXPECT_EQ(read_text(clips().path("named/shots.csv")), table_of_one_process());
}

TEST(Share, WrongRequestsAreRefused) {
  for (const char* options :
       {"--shard 3/2", "--shard 0/2", "--shard 2", "--shard a/b", "--shard 1/", "--share a/b",
        "--lost-after 0.1 --share a", "--join"}) {
    const Outcome refused = clips().batch("refused", options);
    EXPECT_EQ(refused.status, 2) << options << refused.err;
    EXPECT_FALSE(fs::exists(clips().path("refused/.share"))) << options;
  }
  const std::string alien = "PMI_SIZE=2 PMI_RANK=0 ";
  const std::string command =
      alien + IMPACTDIC_PROGRAM + " batch " + quoted(clips().path("clips")) + " -o " +
      quoted(clips().path("alien")) + " 2>" + quoted(clips().path("alien.txt"));
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 2);
  EXPECT_NE(read_text(clips().path("alien.txt")).find("--share NAME"), std::string::npos);
}

}  // namespace
}  // namespace impactdic::testing
