// `track --live`: rows out of a pipe, the same as those of a file.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/program.h"

namespace impactdic::testing {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kFrames = 96;

// A clip whose look at its first frames is that at all of them: the noise is the same.
class Clip {
 public:
  Clip() {
    const Outcome made = run_program(
        "synth --pattern e1 --size 128x128 --radius-px 36 --noise 1 --rotation-deg 0.4 --format "
        "raw "
        "--velocity-px 0.03,0.02 --seed 3 --frames " +
        std::to_string(kFrames) + " -o " + quoted(folder_ / "made"));
    if (made.status != 0) throw std::runtime_error(made.err);
    for (const auto& entry : fs::directory_iterator(folder_ / "made")) {
      if (entry.path().stem() == "video") pixels_ = entry.path();
    }
  }
  const fs::path& pixels() const { return pixels_; }
  fs::path path(const std::string& name) const { return folder_ / name; }
  // The rows of `sender`'s pixels.
  Outcome live(const std::string& sender, const std::string& options) const {
    const ScratchFolder scratch;
    const std::string command = sender + " | " + IMPACTDIC_PROGRAM +
                                " track - --raw 128x128x8 --fps 2000 --live " + options + " > " +
                                quoted(scratch / "out") + " 2> " + quoted(scratch / "err");
    const int raw = std::system(command.c_str());
    return {WIFEXITED(raw) ? WEXITSTATUS(raw) : -1, read_text(scratch / "out"),
            read_text(scratch / "err")};
  }

 private:
  ScratchFolder folder_;
  fs::path pixels_;
};

const Clip& clip() {
  static const Clip made;
  return made;
}

std::vector<json> rows_of(const std::string& text) {
  std::vector<json> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) rows.push_back(json::parse(line));
  return rows;
}

// Of every row what was measured: all but how long it took.
std::vector<json> without_delays(std::vector<json> rows) {
  for (json& row : rows) row.erase("delay_s");
  return rows;
}

const CsvTable& rows_of_the_file() {
  static const CsvTable table = [] {
    const Outcome offline = run_program("track " + quoted(clip().pixels()) +
                                        " --raw 128x128x8 --fps 2000 --mm-per-px 0.5 -q -o " +
                                        quoted(clip().path("offline")));
    if (offline.status != 0) throw std::runtime_error(offline.err);
    return CsvTable(clip().path("offline/track.csv"));
  }();
  return table;
}

// How far a live row lies from that of the file; 0 where neither has a value.
double difference(const json& row, const std::string& column) {
  const std::string cell = rows_of_the_file().text(column)[row["frame"].get<std::size_t>()];
  if (cell.empty() && row[column].is_null()) return 0;
  if (cell.empty() || row[column].is_null()) return INFINITY;
  return std::abs(std::stod(cell) - row[column].get<double>());
}

// Looked at and batched as `track` does it: 64 of these small frames are a batch.
TEST(Live, RowsAreThoseOfTheFile) {
  const Outcome live = clip().live("cat " + quoted(clip().pixels()),
                                   "--lag 0 --mm-per-px 0.5 --look 96 --wait 0.064");
  ASSERT_EQ(live.status, 0) << live.err;
  const std::vector<json> rows = rows_of(live.out);
  ASSERT_EQ(rows.size(), std::size_t{kFrames});
  for (const json& row : rows) {
    const auto frame = row["frame"].get<std::size_t>();
    EXPECT_EQ(row["status"], rows_of_the_file().text("status")[frame]);
    EXPECT_GT(row["delay_s"], 0);
    for (const char* column : {"time_s", "cx_px", "cy_px", "r_px", "cx_sd_px", "dx_px", "dy_px",
                               "rot_deg", "dx_sd_px", "vx_m_s", "omega_rad_s"}) {
      EXPECT_EQ(difference(row, column), 0) << column << " of frame " << frame;
    }
  }
}

// In small batches other circles are measured first, and windows are sought from elsewhere: rows
// differ by a part of what they state as their deviation (docs/live.md).
TEST(Live, SmallBatchesStayWithinTheDeviations) {
  const Outcome live =
      clip().live("cat " + quoted(clip().pixels()), "--lag 0 --mm-per-px 0.5 --look 96");
  ASSERT_EQ(live.status, 0) << live.err;
  std::size_t measured = 0;
  for (const json& row : rows_of(live.out)) {
    EXPECT_LT(difference(row, "cx_px"), row["cx_sd_px"].get<double>());
    EXPECT_LT(difference(row, "r_px"), row["r_sd_px"].get<double>());
    if (row["dx_px"].is_null()) continue;
    ++measured;
    EXPECT_LT(difference(row, "dx_px"), row["dx_sd_px"].get<double>());
    EXPECT_LT(difference(row, "rot_deg"), row["rot_sd_deg"].get<double>());
  }
  EXPECT_EQ(measured, std::size_t{kFrames - 1});
}

// When frames come changes nothing: here they come in bursts.
TEST(Live, TheSenderPaceChangesNoRow) {
  const std::string bursts = "(for k in 0 1 2; do dd if=" + quoted(clip().pixels()) +
                             " bs=16384 skip=$((k * 32)) count=32 status=none; sleep 0.2; done)";
  const Outcome paced = clip().live(bursts, "--lag 0");
  ASSERT_EQ(paced.status, 0) << paced.err;
  const Outcome quick = clip().live("cat " + quoted(clip().pixels()), "--lag 0");
  EXPECT_EQ(without_delays(rows_of(paced.out)), without_delays(rows_of(quick.out)));
}

TEST(Live, FramesThatCannotBeKeptUpWithAreMarked) {
  const std::string many =
      "(for k in 0 1 2 3 4 5 6 7; do cat " + quoted(clip().pixels()) + "; done)";
  const Outcome live = clip().live(many, "--lag 0.01");
  ASSERT_EQ(live.status, 0) << live.err;
  const std::vector<json> rows = rows_of(live.out);
  ASSERT_LE(rows.size(), std::size_t{8 * kFrames});
  std::size_t dropped = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i]["frame"], i);
    if (rows[i]["status"] != "dropped") continue;
    ++dropped;
    EXPECT_TRUE(rows[i]["cx_px"].is_null());
    EXPECT_TRUE(rows[i]["delay_s"].is_null());
  }
  EXPECT_GT(dropped, 0u);
  EXPECT_NE(live.err.find(std::to_string(dropped) + " dropped"), std::string::npos) << live.err;
}

TEST(Live, WaitsForABall) {
  const std::string dark = "head -c " + std::to_string(70 * 128 * 128) + " /dev/zero";
  const Outcome live =
      clip().live("(" + dark + "; cat " + quoted(clip().pixels()) + ")", "--lag 0");
  ASSERT_EQ(live.status, 0) << live.err;
  const std::vector<json> rows = rows_of(live.out);
  ASSERT_EQ(rows.size(), std::size_t{70 + kFrames});
  EXPECT_EQ(rows[0]["status"], "no_ball");
  EXPECT_EQ(rows[69]["status"], "no_ball");
  EXPECT_EQ(rows[80]["status"], "ok");
  const Outcome none = clip().live(dark, "--lag 0");
  EXPECT_EQ(none.status, 0) << none.err;
  EXPECT_EQ(rows_of(none.out).size(), 70u);
}

TEST(Live, WrongRequestsAreRefused) {
  const std::string nothing = "head -c 100 /dev/zero";
  const Outcome cut = clip().live(nothing, "");
  EXPECT_EQ(cut.status, 1);
  EXPECT_NE(cut.err.find("the stream ends within a frame"), std::string::npos) << cut.err;
  for (const char* options : {"-o somewhere", "--look 1", "--wait 0", "--lag -1"}) {
    EXPECT_EQ(clip().live(nothing, options).status, 2) << options;
  }
  EXPECT_EQ(run_program("track - --raw 128x128x8 --live < /dev/null").status, 2);  // no --fps
  EXPECT_EQ(run_program("track - --fps 2000 --live < /dev/null").status, 2);
  EXPECT_EQ(run_program("track - --raw 128x128x8 --fps 9 -o out < /dev/null").status, 2);
  const Outcome nowhere = run_program("track clip.cine");
  EXPECT_EQ(nowhere.status, 2);
  EXPECT_NE(nowhere.err.find("--output is required"), std::string::npos) << nowhere.err;
}

}  // namespace
}  // namespace impactdic::testing
