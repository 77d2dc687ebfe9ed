// A camera from pictures, and a shot through it, from outside.
#include <gtest/gtest.h>
#include <impactdic/camera/model.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/camera/through_lens.h"
#include "tests/support/program.h"
#ifdef IMPACTDIC_WITH_CALIBRATION
#include "host/video/frame_sink.h"
#include "tests/support/camera/target_pictures.h"
#endif

namespace impactdic::testing {
namespace {

constexpr int kSide = 320;
constexpr double kMetrePerPx = 3e-4;

nlohmann::json summary_of(const std::filesystem::path& folder) {
  return nlohmann::json::parse(read_text(folder / "summary.json"));
}

// A ball of constant speed through 1 % of distortion.
class ShotThroughALens : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new ScratchFolder;
    const Outcome made = run_program(
        "synth -q -o " + quoted(*folder_ / "clip") +
        " --size 320x320 --radius-px 45 --frames 24 --velocity-px 5.3,4.7 --rotation-deg 1.5 "
        "--noise 1 --distortion 0.01 --fps 10000");
    ASSERT_EQ(made.status, 0) << made.err;
    write_camera(bent_camera(kSide, kMetrePerPx), folder_->file("camera.toml"));
  }
  static void TearDownTestSuite() { delete folder_; }

  static Outcome track(const std::string& into, const std::string& options) {
    return run_program("track " + quoted(*folder_ / "clip" / "video.tif") + " -o " +
                       quoted(*folder_ / into) + " --body disc " + options);
  }
  static ScratchFolder* folder_;
};
ScratchFolder* ShotThroughALens::folder_ = nullptr;

struct Scatter {
  double mean = 0, sd = 0;
};
Scatter scatter(const std::vector<double>& values) {
  double sum = 0, squares = 0;
  int count = 0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    sum += value, squares += value * value, ++count;
  }
  const double mean = sum / count;
  return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean))};
}

TEST_F(ShotThroughALens, IsOfConstantSpeedInMetres) {
  const Outcome tracked = track("corrected", "--camera " + quoted(*folder_ / "camera.toml"));
  ASSERT_EQ(tracked.status, 0) << tracked.err;
  const CsvTable table(*folder_ / "corrected" / "track.csv");
  const CsvTable truth(*folder_ / "clip" / "truth.csv");
  constexpr double kUnit = kMetrePerPx * 10000;  // m/s of a px/frame
  const Scatter vx = scatter(table.numbers("vx_m_s")), vy = scatter(table.numbers("vy_m_s"));
  EXPECT_NEAR(vx.mean / kUnit, 5.3, 0.0015);
  EXPECT_NEAR(vy.mean / kUnit, -4.7, 0.0015);
  // One pair of this ball (45 px, noise 1) is known to about 0.001 px.
  EXPECT_LT(vx.sd / kUnit, 0.003);
  EXPECT_LT(vy.sd / kUnit, 0.003);
  EXPECT_GT(scatter(table.numbers("dx_px")).sd, 0.005);  // as the picture bends it
  const auto x = table.numbers("x_m"), y = table.numbers("y_m");
  const auto cx = truth.numbers("cx_px"), cy = truth.numbers("cy_px");
  // World axes begin where the bottom left pixel looks, which the lens has moved.
  const double x_off = x[12] / kMetrePerPx - cx[12];
  const double y_off = y[12] / kMetrePerPx + cy[12];
  double squares = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    squares += std::pow(x[i] / kMetrePerPx - x_off - cx[i], 2) +
               std::pow(y_off - y[i] / kMetrePerPx - cy[i], 2);
  }
  // A circle of this size is known to 0.02 px; the lens moves it by up to 0.9.
  EXPECT_LT(std::sqrt(squares / 2 / static_cast<double>(x.size())), 0.025);
  const nlohmann::json summary = summary_of(*folder_ / "corrected");
  EXPECT_NEAR(summary["scale"]["m_per_px"].get<double>(), kMetrePerPx, 1e-3 * kMetrePerPx);
  EXPECT_EQ(summary["scale"]["from"], "--camera");
  EXPECT_EQ(summary["camera"]["from"], "dots");
  EXPECT_NE(read_text(*folder_ / "corrected" / "job.toml").find("camera.toml"), std::string::npos);
}

// The ball that fills half of the picture, at a usual noise: what the lens does is gone from speed
// and path, down to what one pair is known to.
TEST_F(ShotThroughALens, ALargeBallsSpeedIsConstantOnItsWay) {
  const std::string clip = quoted(*folder_ / "large");
  const Outcome made =
      run_program("synth -q -o " + clip +
                  " --pattern a1 --size 512x512 --radius-px 115 --frames 34 --velocity-px 7.3,6.7 "
                  "--rotation-deg 1.5 --noise 2 --distortion 0.01 --fps 10000");
  ASSERT_EQ(made.status, 0) << made.err;
  write_camera(bent_camera(512, kMetrePerPx), folder_->file("large.toml"));
  const Outcome tracked = run_program(
      "track " + quoted(*folder_ / "large" / "video.tif") + " -q --body disc --camera " +
      quoted(*folder_ / "large.toml") + " -o " + quoted(*folder_ / "large_out"));
  ASSERT_EQ(tracked.status, 0) << tracked.err;
  const CsvTable table(*folder_ / "large_out" / "track.csv");
  const CsvTable truth(*folder_ / "large" / "truth.csv");
  constexpr double kUnit = kMetrePerPx * 10000;  // m/s of a px/frame
  const auto check = [&](const char* speed, const char* path, const char* centre, double expected,
                         double way_up) {
    std::vector<double> v = table.numbers(speed);
    v.pop_back();  // the last frame has no next one
    ASSERT_EQ(v.size(), 33u);
    // The means of thirds: a speed that changes on the way shows in them.
    for (std::size_t third = 0; third < 3; ++third) {
      const auto from = v.begin() + static_cast<std::ptrdiff_t>(11 * third);
      const Scatter part = scatter({from, from + 11});
      EXPECT_NEAR(part.mean / kUnit, expected, 0.0008) << speed << ", third " << third;
      EXPECT_LT(part.sd / kUnit, 0.0012) << speed << ", third " << third;
    }
    std::vector<double> off;
    const auto at = table.numbers(path), is = truth.numbers(centre);
    for (std::size_t i = 0; i < at.size(); ++i) off.push_back(at[i] / kMetrePerPx - way_up * is[i]);
    EXPECT_LT(scatter(off).sd, 0.012) << path;
  };
  check("vx_m_s", "x_m", "cx_px", 7.3, 1);
  check("vy_m_s", "y_m", "cy_px", -6.7, -1);
}

TEST_F(ShotThroughALens, WithoutACameraTheBendIsTold) {
  const Outcome tracked = track("plain", "--mm-per-px 0.3");
  ASSERT_EQ(tracked.status, 0) << tracked.err;
  EXPECT_NE(tracked.err.find("the flights bend as through a lens"), std::string::npos)
      << tracked.err;
  EXPECT_NE(tracked.err.find("impactdic calibrate"), std::string::npos) << tracked.err;
}

TEST_F(ShotThroughALens, WrongCamerasAreRefusedInOneLine) {
  Camera other = bent_camera(512, kMetrePerPx);
  write_camera(other, folder_->file("other.toml"));
  const Outcome size = track("a", "--camera " + quoted(*folder_ / "other.toml"));
  EXPECT_EQ(size.status, 2);
  EXPECT_NE(size.err.find("512 x 512 px, the clip has 320 x 320"), std::string::npos) << size.err;
  const Outcome twice = track("b", "--mm-per-px 0.3 --camera " + quoted(*folder_ / "camera.toml"));
  EXPECT_EQ(twice.status, 2);
  const Outcome none = track("c", "--camera " + quoted(*folder_ / "nowhere.toml"));
  EXPECT_EQ(none.status, 1);
  std::ofstream(*folder_ / "bad.toml") << "schema = 1\n";
  const Outcome bad = track("d", "--camera " + quoted(*folder_ / "bad.toml"));
  EXPECT_EQ(bad.status, 1);
  EXPECT_NE(bad.err.find("is missing"), std::string::npos) << bad.err;
}

// The ball as a surface: its first two frames, of which the second is shifted.
TEST_F(ShotThroughALens, CorrelateAndInfoGoThroughTheCameraToo) {
  const std::string clip = quoted(*folder_ / "clip" / "video.tif");
  const std::string camera = " --camera " + quoted(*folder_ / "camera.toml");
  const Outcome done = run_program("correlate " + clip + " --frames 0:2 --roi 65,75,50,50 -q -o " +
                                   quoted(*folder_ / "field") + camera);
  ASSERT_EQ(done.status, 0) << done.err;
  const CsvTable table(*folder_ / "field" / "motion.csv");
  EXPECT_EQ(table.numbers("dx_m")[0], 0);
  // A lens of 1 % at the corner: by the picture's own pixels the step is off by as much.
  const double dx_px = table.numbers("dx_px")[1], dx = table.numbers("dx_m")[1] / kMetrePerPx;
  EXPECT_GT(std::abs(dx_px - dx), 0.01);
  const nlohmann::json summary = summary_of(*folder_ / "field");
  EXPECT_NEAR(summary["camera"]["m_per_px"]["value"].get<double>(), kMetrePerPx, 1e-7);
  EXPECT_TRUE(summary["noise_floor"].is_null());
  const Outcome info = run_program("info " + clip + camera);
  EXPECT_EQ(info.status, 0) << info.err;
  EXPECT_NE(info.out.find("calibration      0.3 +- 0 mm/px"), std::string::npos) << info.out;
  for (const char* command : {"correlate", "info"}) {
    write_camera(bent_camera(512, kMetrePerPx), folder_->file("other.toml"));
    std::string line =
        std::string(command) + " " + clip + " --camera " + quoted(*folder_ / "other.toml");
    if (command[0] == 'c') line += " -o " + quoted(*folder_ / "never");
    const Outcome refused = run_program(line);
    EXPECT_EQ(refused.status, 2);
    EXPECT_NE(refused.err.find("512 x 512 px, the clip has"), std::string::npos) << refused.err;
  }
  EXPECT_FALSE(std::filesystem::exists(*folder_ / "never"));
}

#ifdef IMPACTDIC_WITH_CALIBRATION

TEST(CalibrateCommand, WritesACameraFromAClipOfTargets) {
  const ScratchFolder folder;
  CalibrateRequest request;
  request.target = CalibrationTarget::kDots;
  request.columns = 9;
  request.rows = 7;
  request.pitch_mm = 10;
  request.dot_mm = 4.5;
  const RandomCalibration made = random_calibration(request, 7, 5);
  const TargetPattern pattern(request);
  ClipInfo info;
  info.width = made.views[0].width;
  info.height = made.views[0].height;
  info.frame_count = static_cast<std::int64_t>(made.views.size());
  const auto sink =
      video::open_sink(folder.file("targets.tif"), video::parse_sink_format("tiff"), info);
  for (const Camera& view : made.views) sink->write(render_target(view, pattern, {}, 1));
  sink->finish();
  const std::string command = "calibrate " + quoted(folder / "targets.tif") +
                              " --target dots --cells 9x7 --pitch-mm 10 --dot-mm 4.5 -o " +
                              quoted(folder / "camera.toml");
  const Outcome done = run_program(command);
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_NE(done.out.find("verdict: "), std::string::npos) << done.out;
  const Camera camera = read_camera(folder.file("camera.toml"));
  EXPECT_NEAR(camera[CameraParameter::kFx], made.views[0][CameraParameter::kFx],
              4 * std::sqrt(camera.variance(CameraParameter::kFx)));
  EXPECT_NE(read_text(folder / "camera.svg").find("</svg>"), std::string::npos);
  const Outcome again = run_program(command);
  EXPECT_EQ(again.status, 2);
  EXPECT_NE(again.err.find("--force"), std::string::npos) << again.err;
  const Outcome plane = run_program(command + " --force --plane nowhere.png");
  EXPECT_EQ(plane.status, 2);
  const Outcome wrong = run_program("calibrate " + quoted(folder / "targets.tif") +
                                    " --target checkerboard --cells 9x7 --pitch-mm 10 -o " +
                                    quoted(folder / "none.toml"));
  EXPECT_EQ(wrong.status, 2) << wrong.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "none.toml"));
  const Outcome ruler = run_program("calibrate " + quoted(folder / "targets.tif") +
                                    " --target ruler --marks 20,50,320,50 --pitch-mm 60 -o " +
                                    quoted(folder / "ruler.toml"));
  EXPECT_EQ(ruler.status, 0) << ruler.err;
  EXPECT_NE(ruler.out.find("scale 0.2000"), std::string::npos) << ruler.out;
  const Outcome no_ticks =
      run_program("calibrate " + quoted(folder / "targets.tif") +
                  " --target ruler --pitch-mm 1 -o " + quoted(folder / "ticks.toml"));
  EXPECT_EQ(no_ticks.status, 2) << no_ticks.out;
  EXPECT_NE(no_ticks.err.find("no even row of eight ticks"), std::string::npos) << no_ticks.err;
}

#endif

}  // namespace
}  // namespace impactdic::testing
