// `track` on a synthetic clip: accuracy, files, job, resume, device.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "host/report/csv.h"
#include "tests/support/data.h"
#include "tests/support/program.h"

namespace impactdic::testing {
namespace {

// A clip with exact truth; pattern e1 and radius 115 px unless said otherwise.
class SyntheticClip {
 public:
  explicit SyntheticClip(const std::string& options) {
    const Outcome outcome = run_program("synth " + options + " -o " + quoted(folder_ / "clip"));
    if (outcome.status != 0) throw std::runtime_error(outcome.err);
  }
  Outcome track(const std::string& out, const std::string& options = "") const {
    return run_program("track " + quoted(folder_ / "clip/video.tif") + " --fps 10000 -o " +
                       quoted(folder_ / out) + " " + options);
  }
  std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  CsvTable truth() const { return CsvTable(folder_ / "clip/truth.csv"); }
  CsvTable result(const std::string& out) const { return CsvTable(path(out) / "track.csv"); }

 private:
  ScratchFolder folder_;
};

const SyntheticClip& turning_clip() {
  static const SyntheticClip clip("--frames 12 --velocity-px 1,1 --rotation-deg 3");
  return clip;
}

void expect_mean_error(const SyntheticClip& clip, const std::string& column, double largest) {
  const auto want = clip.truth().numbers(column), got = clip.result("out").numbers(column);
  ASSERT_EQ(want.size(), got.size());
  double sum = 0;
  for (std::size_t i = 0; i + 1 < got.size(); ++i) {
    ASSERT_FALSE(std::isnan(got[i])) << column << " in frame " << i;
    sum += got[i] - want[i];
  }
  EXPECT_LE(std::abs(sum / static_cast<double>(got.size() - 1)), largest) << column;
}

TEST(Track, MeasuresTranslationWithoutBias) {
  const SyntheticClip clip("--frames 12 --velocity-px 1,0 --rotation-deg 0");
  ASSERT_EQ(clip.track("out").status, 0);
  expect_mean_error(clip, "dx_px", 0.01);
  expect_mean_error(clip, "dy_px", 0.01);
  expect_mean_error(clip, "rot_deg", 0.02);
}

TEST(Track, MeasuresMotionInTwoDirectionsWithSpin) {
  const SyntheticClip& clip = turning_clip();
  ASSERT_EQ(clip.track("out", "--force").status, 0);
  expect_mean_error(clip, "dx_px", 0.01);
  expect_mean_error(clip, "dy_px", 0.01);
  expect_mean_error(clip, "rot_deg", 0.02);
}

// The quickest method: its windows' pull towards their guess leaves no trace in the ball's motion.
TEST(Track, MeasuresWithEqualWindows) {
  const SyntheticClip& clip = turning_clip();
  ASSERT_EQ(clip.track("out", "--force --estimator field --method equal --window 32").status, 0);
  expect_mean_error(clip, "dx_px", 0.05);
  expect_mean_error(clip, "dy_px", 0.05);
  expect_mean_error(clip, "rot_deg", 0.05);
}

// Neither windows nor the last frame's spin reach so far: rings have to find it.
TEST(Track, FindsASpinOfSeventyDegreesAFrameUnseeded) {
  const SyntheticClip clip(
      "--size 240x240 --radius-px 80 --velocity-px 1.3,0.4 --rotation-deg 70 --noise 2 --frames 4");
  for (const char* estimator : {"field", "ball"}) {
    ASSERT_EQ(clip.track("out", std::string("--force --estimator ") + estimator).status, 0);
    const CsvTable table = clip.result("out");
    const auto dx = table.numbers("dx_px"), rot = table.numbers("rot_deg");
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(dx[i], 1.3, 0.1) << estimator << ", frame " << i;  // the circle's error, turned
      EXPECT_NEAR(rot[i], 70, 0.01) << estimator << ", frame " << i;
    }
  }
}

// The ball falls through the picture from above it to below it. Its speckles come first.
TEST(Track, BallThatEntersAndLeavesIsMeasuredWhereItIsSeen) {
  const SyntheticClip clip(
      "--size 256x512 --pattern f1 --radius-px 60 --start-px 120,-40 --velocity-px 1,10 "
      "--rotation-deg 3 --noise 2 --frames 60");
  ASSERT_EQ(clip.track("out").status, 0);
  const CsvTable table = clip.result("out"), truth = clip.truth();
  const auto cy = table.numbers("cy_px"), want = truth.numbers("cy_px"),
             dy = table.numbers("dy_px");
  int measured = 0;
  for (std::size_t i = 0; i < cy.size(); ++i) {
    if (!std::isnan(cy[i])) {
      EXPECT_NEAR(cy[i], want[i], 0.15) << "frame " << i;
    }
    if (std::isnan(dy[i])) continue;
    EXPECT_NEAR(dy[i], 10, 0.02) << "frame " << i;
    ++measured;
  }
  EXPECT_GE(measured, 48);
}

TEST(Track, FilesHoldWhatTheInterfacePromises) {
  const SyntheticClip& clip = turning_clip();
  ASSERT_EQ(
      clip.track("files", "--force --ball-diameter-mm 67 --surface-angle-deg 30 --overlay").status,
      0);
  const CsvTable table = clip.result("files");
  EXPECT_EQ(table.header, report::kTrackCsvHeader);
  ASSERT_EQ(table.rows, 12u);
  EXPECT_EQ(table.text("status").back(), "last_frame");
  EXPECT_EQ(table.text("dx_px").back(), "");
  // 67 mm over the ball's diameter, 10 000 frames/s; world y is up, the image's down.
  const double speed = 0.067 / 230 * 1e4;
  EXPECT_NEAR(table.numbers("vx_m_s")[3], speed, 0.01);
  EXPECT_NEAR(table.numbers("vy_m_s")[3], -speed, 0.01);
  EXPECT_NEAR(table.numbers("vt_m_s")[3], speed * (std::cos(M_PI / 6) - 0.5), 0.01);
  EXPECT_NEAR(table.numbers("vn_m_s")[3], -speed * (0.5 + std::cos(M_PI / 6)), 0.01);
  EXPECT_NEAR(table.numbers("omega_rad_s")[3], 3 * M_PI / 180 * 1e4, 4);
  const auto summary = nlohmann::json::parse(read_text(clip.path("files/summary.json")));
  EXPECT_EQ(summary["frames_by_status"]["ok"], 11);
  EXPECT_NEAR(summary["scale_m_per_px"].get<double>(), 0.067 / 230, 1e-6);
  EXPECT_EQ(summary["input"]["sha256"].get<std::string>().size(), 64u);
  for (const char* name : {"fields.h5", "job.toml", "overlay/frame_000011.png"}) {
    EXPECT_TRUE(std::filesystem::exists(clip.path("files") / name)) << name;
  }
}

TEST(Track, WithoutARateTimesAreEmpty) {
  const ScratchFolder folder;
  ASSERT_EQ(run_program("synth --size 160x160 --radius-px 40 --frames 6 --velocity-px 1,0.5 "
                        "--format raw -o " +
                        quoted(folder / "clip"))
                .status,
            0);
  const Outcome tracked = run_program("track " + quoted(folder / "clip/video.raw") +
                                      " --raw 160x160x8 -o " + quoted(folder / "out"));
  ASSERT_EQ(tracked.status, 0) << tracked.err;
  const CsvTable table(folder / "out/track.csv");
  ASSERT_EQ(table.rows, 6u);
  for (const char* empty : {"time_s", "x_m", "vx_m_s", "omega_rad_s"}) {
    for (const std::string& cell : table.text(empty)) EXPECT_EQ(cell, "") << empty;
  }
  EXPECT_EQ(CsvTable(folder / "out/pose.csv").text("time_s")[1], "");
  EXPECT_EQ(table.text("dx_px")[0].empty(), false);
  // The table is read again.
  EXPECT_EQ(run_program("track " + quoted(folder / "clip/video.raw") +
                        " --raw 160x160x8 --resume -o " + quoted(folder / "out"))
                .status,
            0);
}

TEST(Track, JobFileRerunsBitForBit) {
  const SyntheticClip& clip = turning_clip();
  ASSERT_EQ(clip.track("first", "--force --window 17 --ball-diameter-mm 67").status, 0);
  const Outcome again = run_program("track --job " + quoted(clip.path("first/job.toml")) +
                                    " --force -o " + quoted(clip.path("second")));
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(read_text(clip.path("first/track.csv")), read_text(clip.path("second/track.csv")));
  EXPECT_EQ(read_text(clip.path("first/job.toml")), read_text(clip.path("second/job.toml")));
}

// Seven batches of frames; the ball is hit after the first ninety.
class LongClip {
 public:
  LongClip() {
    std::string motion = "cx_px,cy_px,angle_deg\n";
    for (int k = 0; k < kFrames; ++k) {
      const double fall = k < 90 ? k : 90 - 0.05 * (k - 90);
      motion += std::to_string(50 + 0.04 * k) + "," + std::to_string(45 + 0.5 * fall) + "," +
                std::to_string(k < 90 ? 0.3 * k : 27 + 2.0 * (k - 90)) + "\n";
    }
    std::ofstream(folder_ / "motion.csv") << motion;
    const Outcome made = run_program(
        "synth --pattern e1 --size 128x128 --radius-px 36 --noise 1 --format mraw --motion " +
        quoted(folder_ / "motion.csv") + " -o " + quoted(folder_ / "clip"));
    if (made.status != 0) throw std::runtime_error(made.err);
  }
  static constexpr int kFrames = 400;
  std::string command(const std::string& out, const std::string& options) const {
    return "track " + quoted(folder_ / "clip/video.cihx") + " -o " + quoted(folder_ / out) +
           " --spacing 11 " + options;
  }
  std::filesystem::path path(const std::string& name) const { return folder_ / name; }

 private:
  ScratchFolder folder_;
};

const LongClip& long_clip() {
  static const LongClip clip;
  return clip;
}

// Every dataset and attribute, to the last bit.
bool same_fields(const std::filesystem::path& a, const std::filesystem::path& b) {
  const std::string script =
      "import h5py, sys; a, b = map(h5py.File, sys.argv[1:]); "
      "same = lambda k: not isinstance(a[k], h5py.Dataset) or (a[k].shape == b[k].shape and "
      "a[k][()].tobytes() == b[k][()].tobytes()); "
      "sys.exit(set(a) != set(b) or not all(map(same, a)) or dict(a.attrs) != dict(b.attrs))";
  const std::string command = "/usr/bin/python3 -c '" + script + "' " + quoted(a / "fields.h5") +
                              " " + quoted(b / "fields.h5");
  return std::system(command.c_str()) == 0;
}

class TrackResume : public ::testing::TestWithParam<const char*> {};

// Killed in the middle, whatever it was at.
TEST_P(TrackResume, AKilledRunGoesOnToTheSameFiles) {
  const std::string options =
      std::string("--force --ball-diameter-mm 67 --estimator ") + GetParam();
  const LongClip& clip = long_clip();
  ASSERT_EQ(run_program(clip.command("whole", options)).status, 0);
  std::filesystem::remove_all(clip.path("parts"));
  const std::string point = quoted(clip.path("parts/resume.json"));
  const std::string script = std::string(IMPACTDIC_PROGRAM) + " " + clip.command("parts", options) +
                             " -q & pid=$!; while kill -0 $pid && [ ! -e " + point +
                             " ]; do sleep 0.02; done; kill -9 $pid; wait $pid";
  ASSERT_EQ(std::system(("exec 2> /dev/null; " + script + "; true").c_str()), 0);
  const CsvTable killed(clip.path("parts/track.csv"));
  // As a run that was killed while it wrote may leave it.
  std::ofstream(clip.path("parts/track.csv"), std::ios::app) << killed.rows << ",0.00";
  const Outcome outcome = run_program(clip.command(
      "parts", std::string("--resume --ball-diameter-mm 67 --estimator ") + GetParam()));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* name : {"track.csv", "pose.csv"}) {
    if (!std::filesystem::exists(clip.path("whole") / name)) continue;
    EXPECT_EQ(read_text(clip.path("whole") / name), read_text(clip.path("parts") / name)) << name;
  }
  EXPECT_TRUE(same_fields(clip.path("whole"), clip.path("parts")));
}

INSTANTIATE_TEST_SUITE_P(Estimators, TrackResume,
                         ::testing::Values("field", "ball", "ball --body sphere"));

TEST(Track, ResumeWithOtherOptionsIsRefused) {
  const LongClip& clip = long_clip();
  ASSERT_EQ(run_program(clip.command("other", "--no-field --force --ball-diameter-mm 67")).status,
            0);
  const Outcome window =
      run_program(clip.command("other", "--no-field --resume --radius-px 30:40"));
  EXPECT_EQ(window.status, 2);
  EXPECT_NE(window.err.find("radius-px"), std::string::npos) << window.err;
  // The scale is no part of what was measured.
  EXPECT_EQ(run_program(clip.command("other", "--no-field --resume --ball-diameter-mm 60")).status,
            0);
}

// The ball is hit in the second batch of frames.
TEST(Track, NeitherThreadsNorDevicesChangeAResult) {
  const LongClip& clip = long_clip();
  // On PoCL: two devices, both of them all cores.
  ::setenv("POCL_DEVICES", "pthread pthread", 1);
  const auto track = [&](const std::string& name, const std::string& options) {
    const Outcome outcome = run_program(clip.command(name, "--force --frames 0:140 " + options));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return read_text(clip.path(name) / "track.csv");
  };
  const std::string one = track("one", "-j 1");
  EXPECT_EQ(one, track("many", ""));
  EXPECT_EQ(one, track("devices", "--device all"));
  ::unsetenv("POCL_DEVICES");
  const CsvTable table(clip.path("one/track.csv"));
  ASSERT_EQ(table.rows, 140u);
  for (std::size_t k = 0; k + 1 < table.rows; ++k) {
    ASSERT_EQ(table.text("status")[k], "ok") << k;
    EXPECT_NEAR(table.numbers("rot_deg")[k], k < 90 ? 0.3 : 2, 0.05) << k;
  }
}

}  // namespace
}  // namespace impactdic::testing
