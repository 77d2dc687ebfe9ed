// `batch` over a folder of small clips, some of them broken.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace impactdic::testing {
namespace {

namespace fs = std::filesystem;

// Six good clips, one cut in the middle, one without a ball, one that is no clip at all.
class Clips {
 public:
  Clips() {
    fs::create_directories(folder_ / "clips");
    for (int i = 1; i <= 6; ++i) {
      const std::string made = "made" + std::to_string(i);
      synth(made, "--pattern e1 --velocity-px 1,0.5 --seed " + std::to_string(i));
      fs::rename(folder_ / made / "video.tif", clip("shot_" + std::to_string(i) + ".tif"));
    }
    fs::copy(clip("shot_1.tif"), clip("shot_7_cut.tif"));
    fs::resize_file(clip("shot_7_cut.tif"), fs::file_size(clip("shot_7_cut.tif")) / 2);
    synth("bare", "--pattern none --white 30");  // as the background
    fs::rename(folder_ / "bare" / "video.tif", clip("shot_8_bare.tif"));
    std::ofstream(clip("shot_9_text.cine")) << "this is no clip";
  }
  fs::path clip(const std::string& name) const { return folder_ / "clips" / name; }
  fs::path path(const std::string& name) const { return folder_ / name; }
  Outcome batch(const std::string& out, const std::string& options = "") const {
    return run_program("batch " + quoted(folder_ / "clips") + " -o " + quoted(folder_ / out) +
                       " --fps 10000 --ball-diameter-mm 67 " + options);
  }
  std::string command(const std::string& out) const {
    return std::string(IMPACTDIC_PROGRAM) + " batch " + quoted(folder_ / "clips") + " -o " +
           quoted(folder_ / out) + " -q --fps 10000 --ball-diameter-mm 67";
  }

 private:
  void synth(const std::string& name, const std::string& options) const {
    const Outcome made = run_program("synth --size 160x160 --radius-px 40 --frames 6 " + options +
                                     " -o " + quoted(folder_ / name));
    if (made.status != 0) throw std::runtime_error(made.err);
  }
  ScratchFolder folder_;
};

const Clips& clips() {
  static const Clips made;
  return made;
}

void expect_complete(const fs::path& out) {
  const CsvTable table(out / "shots.csv");
  ASSERT_EQ(table.rows, 9u);
  for (std::size_t i = 0; i < 9; ++i) {
    const std::string name = table.text("shot")[i];
    EXPECT_EQ(name.rfind("shot_" + std::to_string(i + 1), 0), 0u) << name;
    const bool good = i < 6;
    EXPECT_EQ(table.text("status")[i], good ? "ok" : "failed") << name;
    EXPECT_EQ(table.text("reason")[i].empty(), good) << name;
    EXPECT_EQ(fs::exists(out / "shots" / name / "track.csv"), good) << name;
    EXPECT_EQ(fs::exists(out / "quarantine" / name / "reason.txt"), !good) << name;
    EXPECT_FALSE(fs::exists(out / "shots" / (name + ".part"))) << name;
    if (name == "shot_8_bare") {
      EXPECT_EQ(table.text("reason")[i], "no ball was measured in any frame");
    }
    if (!good) continue;
    EXPECT_EQ(table.text("frames_ok")[i], "6") << name;
    EXPECT_EQ(table.text("impact")[i], "none") << name;
  }
}

TEST(Batch, MeasuresTheGoodAndPutsTheBrokenAside) {
  std::ofstream(clips().path("table.csv")) << "file,surface_angle_deg,drop_height_mm,notes\n"
                                              "shot_2.tif,30,250,\"new ball, \"\"Fort\"\"\"\n"
                                              "shot_3,,,\n";
  const Outcome outcome =
      clips().batch("all", "--surface-angle-deg 10 --table " + quoted(clips().path("table.csv")));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("warning: 3 of 9 shots failed"), std::string::npos) << outcome.err;
  expect_complete(clips().path("all"));
  const CsvTable table(clips().path("all/shots.csv"));
  EXPECT_EQ(table.text("surface_angle_deg")[0], "10");
  EXPECT_EQ(table.text("surface_angle_deg")[1], "30");
  EXPECT_EQ(table.text("surface_angle_deg")[2], "10");
  EXPECT_EQ(table.text("drop_height_mm")[1], "250");
  EXPECT_EQ(table.text("notes")[1], "new ball; 'Fort'");
}

TEST(Batch, ShotsAreWhatTrackMakesOfThem) {
  ASSERT_EQ(clips().batch("same").status, 0);
  const Outcome alone =
      run_program("track --job " + quoted(clips().path("same/shots/shot_4/job.toml")) + " -o " +
                  quoted(clips().path("alone")));
  ASSERT_EQ(alone.status, 0) << alone.err;
  EXPECT_EQ(read_text(clips().path("alone/track.csv")),
            read_text(clips().path("same/shots/shot_4/track.csv")));
}

TEST(Batch, GoesOnAfterItWasKilled) {
  const std::string killed = "timeout -s KILL 0.9 " + clips().command("killed") + " 2>/dev/null";
  ASSERT_NE(std::system(killed.c_str()), -1);
  const fs::path first = clips().path("killed/shots/shot_1/summary.json");
  const bool had_first = fs::exists(first);
  const auto written = had_first ? fs::last_write_time(first) : fs::file_time_type();
  fs::create_directories(clips().path("killed"));
  const Outcome outcome = clips().batch("killed", "--resume");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  expect_complete(clips().path("killed"));
  if (had_first) {
    EXPECT_EQ(fs::last_write_time(first), written);
  }
  // All there: nothing good is measured again.
  const auto before = fs::last_write_time(first);
  ASSERT_EQ(clips().batch("killed", "--resume").status, 0);
  EXPECT_EQ(fs::last_write_time(first), before);
}

// What the table says of a shot counts, also when it is corrected after the clips were measured.
TEST(Batch, ACorrectedTableTakesEffect) {
  const auto table = [](const char* rows) {
    std::ofstream(clips().path("ball.csv"))
        << "file,surface_angle_deg,ball_diameter_mm,inertia_factor,ball,mass_g\n"
        << rows;
  };
  const std::string options = "--table " + quoted(clips().path("ball.csv"));
  table("shot_1,10,67,0.667,tennis,56.7\n");
  ASSERT_EQ(clips().batch("corrected", options).status, 0);
  const double wrong = CsvTable(clips().path("corrected/shots.csv")).numbers("scale_m_per_px")[0];
  table("shot_1,30,63.25,0.4,lacrosse,145.66\n");
  ASSERT_EQ(clips().batch("corrected", options + " --resume").status, 0);
  const CsvTable now(clips().path("corrected/shots.csv"));
  EXPECT_EQ(now.text("surface_angle_deg")[0], "30");
  EXPECT_EQ(now.text("ball")[0], "lacrosse");
  EXPECT_EQ(now.text("mass_g")[0], "145.66");
  EXPECT_EQ(now.text("inertia_factor")[0], "0.4");
  EXPECT_NEAR(now.numbers("scale_m_per_px")[0], wrong * 63.25 / 67, 1e-9);
  EXPECT_GT(now.numbers("scale_sd_m_per_px")[0], 0);
  EXPECT_EQ(now.text("ball_diameter_mm")[1], "67");  // as the command says
  // Nothing was measured again.
  const auto summary =
      nlohmann::json::parse(read_text(clips().path("corrected/shots/shot_1/summary.json")));
  EXPECT_TRUE(summary["frames_per_s"].is_null());
  table("shot_1,30,-5,0.4,lacrosse,145\n");
  EXPECT_EQ(clips().batch("corrected", options + " --resume").status, 2);
}

// The device opens beside the first looks; no shot is to blame where there is none.
TEST(Batch, ADeviceThatIsNotThereEndsItAndPutsNoShotAside) {
  const Outcome outcome = clips().batch("no_device", "--device none_of_this_name");
  EXPECT_NE(outcome.status, 0);
  EXPECT_NE(outcome.err.find("none_of_this_name"), std::string::npos) << outcome.err;
  EXPECT_FALSE(fs::exists(clips().path("no_device") / "quarantine"));
  for (const auto& entry : fs::directory_iterator(clips().path("no_device") / "shots")) {
    EXPECT_NE(entry.path().extension(), ".part") << entry.path();
  }
}

TEST(Batch, WrongRequestsAreRefused) {
  std::ofstream(clips().path("bad.csv")) << "file\nshot_77.tif\n";
  const Outcome unknown = clips().batch("bad", "--table " + quoted(clips().path("bad.csv")));
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("shot_77.tif"), std::string::npos) << unknown.err;
  const Outcome none = run_program("batch " + quoted(clips().path("nowhere")) + " -o " +
                                   quoted(clips().path("none")));
  EXPECT_EQ(none.status, 2);
}

}  // namespace
}  // namespace impactdic::testing
