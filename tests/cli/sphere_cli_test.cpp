// `track` on a ball that turns about any axis: what `--body` takes it for, and what it measures.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace impactdic::testing {
namespace {

// A ball of 60 px on small pictures.
class SphereClip {
 public:
  explicit SphereClip(const std::string& options,
                      const std::string& size = "--radius-px 60 --size 176x176 --frames 9") {
    const Outcome outcome = run_program("synth --body sphere --noise 2 " + size + " " + options +
                                        " -o " + quoted(folder_ / "clip"));
    if (outcome.status != 0) throw std::runtime_error(outcome.err);
  }
  Outcome track(const std::string& options = "") const {
    return run_program("track " + quoted(folder_ / "clip/video.tif") + " --fps 10000 -o " +
                       quoted(folder_ / "out") + " " +
                       (options.find("--resume") == std::string::npos ? "--force " : "") + options);
  }
  CsvTable rows() const { return CsvTable(folder_ / "out/track.csv"); }
  CsvTable poses() const { return CsvTable(folder_ / "out/pose.csv"); }
  CsvTable truth() const { return CsvTable(folder_ / "clip/truth.csv"); }
  nlohmann::json summary() const {
    return nlohmann::json::parse(read_text(folder_ / "out/summary.json"));
  }

 private:
  ScratchFolder folder_;
};

// Every row within six stated deviations of the truth, all but the last row, which has no next one.
void expect_right(const CsvTable& rows, const CsvTable& truth, const std::string& column,
                  const std::string& sd_column, double largest_sd) {
  const auto got = rows.numbers(column), sd = rows.numbers(sd_column), want = truth.numbers(column);
  for (std::size_t i = 0; i + 1 < want.size(); ++i) {
    EXPECT_LE(std::abs(got[i] - want[i]), 6 * sd[i]) << column << " of row " << i;
    EXPECT_LE(sd[i], largest_sd) << column << " of row " << i;
  }
}

TEST(Sphere, TurnsAboutAnyAxisAreMeasuredWithoutBeingAskedFor) {
  const SphereClip clip("--velocity-px 0.73,-0.41 --spin-deg 1.8,-2.2,3");
  const Outcome outcome = clip.track();
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(clip.summary()["body"]["kind"], "sphere");
  // Parallel rays, as the pictures tell.
  const auto nearness = clip.summary()["body"]["radius_over_distance"];
  EXPECT_EQ(nearness["from"], "pictures");
  EXPECT_LE(std::abs(nearness["value"].get<double>()), 4 * nearness["sd"].get<double>());
  EXPECT_LE(nearness["sd"].get<double>(), 0.006);
  EXPECT_EQ(outcome.err.find("distance is not known"), std::string::npos) << outcome.err;
  const CsvTable rows = clip.rows(), truth = clip.truth();
  for (std::size_t i = 0; i + 1 < rows.rows; ++i) EXPECT_EQ(rows.text("status")[i], "ok") << i;
  expect_right(rows, truth, "dx_px", "dx_sd_px", 0.02);
  expect_right(rows, truth, "dy_px", "dy_sd_px", 0.02);
  expect_right(rows, truth, "rot_x_deg", "rot_x_sd_deg", 0.02);
  expect_right(rows, truth, "rot_y_deg", "rot_y_sd_deg", 0.02);
  expect_right(rows, truth, "rot_deg", "rot_sd_deg", 0.01);
}

TEST(Sphere, PosesAreOrientationsWithoutDrift) {
  const SphereClip clip("--velocity-px 0.4,0.2 --spin-deg 5,-7,4");
  const double turn_deg = std::hypot(5, -7, 4);
  ASSERT_EQ(clip.track().status, 0);
  const CsvTable poses = clip.poses(), truth = clip.truth();
  const auto quaternion = [](const CsvTable& table, std::size_t i) {
    return Eigen::Quaterniond(table.numbers("qw")[i], table.numbers("qx")[i],
                              table.numbers("qy")[i], table.numbers("qz")[i]);
  };
  for (std::size_t i = 0; i < truth.rows; ++i) {
    const double off_deg = quaternion(poses, i).angularDistance(quaternion(truth, i)) * 180 / M_PI;
    const double sd_deg =
        std::hypot(poses.numbers("tilt_x_sd_deg")[i], poses.numbers("tilt_y_sd_deg")[i],
                   poses.numbers("angle_sd_deg")[i]);
    // A radius of 60 px that is known to 0.05 px errs alike in every frame: by twice its share.
    EXPECT_LE(sd_deg, 0.02 + 2.2 * 0.05 / 60 * turn_deg * static_cast<double>(i)) << i;
    EXPECT_LE(off_deg, 0.06) << i;
    EXPECT_LE(off_deg, 2.5 * sd_deg + 1e-9) << i;
    EXPECT_TRUE(std::isnan(poses.numbers("angle_deg")[i]));
  }
}

// At such turns what the circle of a small ball is not known to (0.05 px) is most of the deviation.
TEST(Sphere, LargeTurnsAreFoundWithoutAGuess) {
  const SphereClip clip("--velocity-px 0.5,0.5 --spin-deg 20,-25,15");
  ASSERT_EQ(clip.track().status, 0);
  const CsvTable rows = clip.rows(), truth = clip.truth();
  expect_right(rows, truth, "rot_x_deg", "rot_x_sd_deg", 0.1);
  expect_right(rows, truth, "rot_y_deg", "rot_y_sd_deg", 0.1);
  expect_right(rows, truth, "rot_deg", "rot_sd_deg", 0.1);
}

// What looked like flight: two thirds of the radius times the turn.
TEST(Sphere, AStillBallThatTurnsDoesNotFly) {
  const SphereClip clip("--velocity-px 0,0 --spin-deg 0,1,0");
  ASSERT_EQ(clip.track().status, 0);
  expect_right(clip.rows(), clip.truth(), "dx_px", "dx_sd_px", 0.02);
  ASSERT_EQ(clip.track("--body disc").status, 0);
  const CsvTable rows = clip.rows();
  for (std::size_t i = 0; i + 1 < rows.rows; ++i) {
    EXPECT_EQ(rows.text("status")[i], "inconsistent") << i;
    EXPECT_TRUE(rows.text("rot_x_deg")[i].empty());
  }
}

// Windows alone are fitted as a disc's: the circles must say that this is none.
TEST(Sphere, WindowsAloneAreContradictedByTheCircles) {
  const SphereClip clip("--velocity-px 0,0 --spin-deg 0,1,0");
  ASSERT_EQ(clip.track("--estimator field").status, 0);
  const CsvTable rows = clip.rows();
  for (std::size_t i = 0; i + 1 < rows.rows; ++i) {
    EXPECT_EQ(rows.text("status")[i], "inconsistent") << i;
    EXPECT_GT(rows.numbers("dx_sd_px")[i], 0) << i;
  }
}

TEST(Sphere, ASpinInThePictureIsADiscs) {
  const SphereClip clip("--velocity-px 1,0.5 --spin-deg 0,0,3");
  ASSERT_EQ(clip.track().status, 0);
  EXPECT_EQ(clip.summary()["body"]["kind"], "disc");
  expect_right(clip.rows(), clip.truth(), "dx_px", "dx_sd_px", 0.01);
  // A disc has no perspective.
  const std::vector<std::string> dx = clip.rows().text("dx_px");
  ASSERT_EQ(clip.track("--ball-diameter-mm 40 --distance-mm 200").status, 0);
  EXPECT_EQ(clip.rows().text("dx_px"), dx);
  const Outcome sphere = clip.track("--body sphere");
  ASSERT_EQ(sphere.status, 0);
  EXPECT_EQ(clip.summary()["body"]["kind"], "sphere");
  // Whether it turns out of the picture as it flies by, or is seen from near by, no picture tells.
  EXPECT_NE(sphere.err.find("distance is not known"), std::string::npos) << sphere.err;
  EXPECT_EQ(clip.summary()["body"]["radius_over_distance"]["from"], "nothing");
  expect_right(clip.rows(), clip.truth(), "rot_x_deg", "rot_x_sd_deg", 0.06);
  // Far away is near enough to parallel rays.
  ASSERT_EQ(clip.track("--body sphere --ball-diameter-mm 40 --distance-mm 1e6").status, 0);
  expect_right(clip.rows(), clip.truth(), "rot_x_deg", "rot_x_sd_deg", 0.01);
}

// From 25 radii away parallel rays read 4 % more of these turns, 0.08 degrees, and the flight
// across the picture as a turn of 0.02 degrees.
TEST(Sphere, SeenFromNearByItTurnsAsMuch) {
  const SphereClip clip("--velocity-px 0.6,-0.4 --spin-deg 1.8,-2.2,3 --distance 25");
  const Outcome outcome = clip.track("--ball-diameter-mm 40 --distance-mm 500");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err.find("distance is not known"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("from 25 of its radii away"), std::string::npos) << outcome.err;
  const CsvTable rows = clip.rows(), truth = clip.truth();
  expect_right(rows, truth, "dx_px", "dx_sd_px", 0.02);
  expect_right(rows, truth, "dy_px", "dy_sd_px", 0.02);
  expect_right(rows, truth, "rot_x_deg", "rot_x_sd_deg", 0.02);
  expect_right(rows, truth, "rot_y_deg", "rot_y_sd_deg", 0.02);
  expect_right(rows, truth, "rot_deg", "rot_sd_deg", 0.01);
  // Rows of one perspective are no part of a run in another.
  const Outcome other = clip.track("--ball-diameter-mm 40 --distance-mm 600 --resume");
  EXPECT_EQ(other.status, 2) << other.err;
  EXPECT_NE(other.err.find("the earlier run has distance-mm '500', this one '600'"),
            std::string::npos)
      << other.err;
}

// The same without being told: pictures of a ball that turns show it.
TEST(Sphere, TurnsTellFromWhereItIsSeen) {
  const SphereClip clip("--velocity-px 0.6,-0.4 --spin-deg 1.8,-2.2,3 --distance 25");
  const Outcome outcome = clip.track();
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto nearness = clip.summary()["body"]["radius_over_distance"];
  EXPECT_EQ(nearness["from"], "pictures");
  EXPECT_LE(std::abs(nearness["value"].get<double>() - 0.04), 3 * nearness["sd"].get<double>());
  EXPECT_LE(nearness["sd"].get<double>(), 0.004);
  const CsvTable rows = clip.rows(), truth = clip.truth(), poses = clip.poses();
  expect_right(rows, truth, "dx_px", "dx_sd_px", 0.03);
  expect_right(rows, truth, "dy_px", "dy_sd_px", 0.03);
  expect_right(rows, truth, "rot_x_deg", "rot_x_sd_deg", 0.03);
  expect_right(rows, truth, "rot_y_deg", "rot_y_sd_deg", 0.03);
  expect_right(rows, truth, "rot_deg", "rot_sd_deg", 0.01);
  // An error of the distance is the same in every link of the chain of poses.
  const auto sd = poses.numbers("tilt_y_sd_deg");
  EXPECT_GT(sd[8], 4 * nearness["sd"].get<double>() * 2.2);
}

// Of a distance that is given with a deviation, that is a part of every turn's.
TEST(Sphere, AnUnsureDistanceIsPartOfTheDeviations) {
  const SphereClip clip("--velocity-px 0.6,-0.4 --spin-deg 1.8,-2.2,3 --distance 25");
  const std::string given = "--ball-diameter-mm 40 --distance-mm ";
  ASSERT_EQ(clip.track(given + "500").status, 0);
  const auto sure = clip.rows().numbers("rot_y_sd_deg");
  ASSERT_EQ(clip.track(given + "570 --distance-sd-mm 70").status, 0);
  const CsvTable rows = clip.rows();
  const auto unsure = rows.numbers("rot_y_sd_deg");
  for (std::size_t i = 0; i + 1 < rows.rows; ++i) EXPECT_GT(unsure[i], 1.1 * sure[i]) << i;
  expect_right(rows, clip.truth(), "rot_y_deg", "rot_y_sd_deg", 0.05);
  EXPECT_EQ(clip.summary()["body"]["radius_over_distance"]["from"], "distance");
}

// A ball that flies past a camera near by shows more and more of another side, though it turns in
// the picture alone: by 0.04 degrees a frame. As a disc's its motion would be 4 % of 2/3 off.
TEST(Sphere, ATurnTooSlowForNeighboursAddsUp) {
  const SphereClip clip("--velocity-px 1,0.5 --spin-deg 0,0,3 --distance 25");
  const Outcome outcome = clip.track();
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(clip.summary()["body"]["kind"], "sphere") << outcome.err;
  const CsvTable rows = clip.rows(), truth = clip.truth();
  expect_right(rows, truth, "dx_px", "dx_sd_px", 0.02);
  expect_right(rows, truth, "dy_px", "dy_sd_px", 0.02);
  // A turn seen from afar, or none seen from near by: these pictures look alike.
  EXPECT_EQ(clip.summary()["body"]["radius_over_distance"]["from"], "nothing");
  expect_right(rows, truth, "rot_x_deg", "rot_x_sd_deg", 0.06);
  expect_right(rows, truth, "rot_y_deg", "rot_y_sd_deg", 0.06);
}

// Pictures of a thing that shows another outline in every frame, as a fruit on rollers does.
// Pressed by 9 % while it turns about all axes: the shape is followed through the contact, and the
// friction of the picture's plane is not taken for the whole.
TEST(Sphere, AnImpactWithSideSpinIsResolved) {
  const SphereClip clip(
      "--lamp 0.2 --seed 192 --background 30 --touch-frame 55 --simulate " +
          quoted(std::filesystem::path(IMPACTDIC_SOURCE_DIR) / "sim/jobs/racket_30_spin.toml"),
      "--radius-px 60 --size 360x360 --frames 190 --pattern e1");
  const Outcome outcome =
      clip.track("--ball-diameter-mm 67 --surface-angle-deg 30 --inertia-factor 0.667");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto impact = clip.summary()["impact"];
  EXPECT_EQ(impact["status"], "found");
  const auto near = [](const nlohmann::json& figure, double truth, double most_sd) {
    const double sd = figure["sd"];
    EXPECT_LE(std::abs(figure["value"].get<double>() - truth), 4 * sd);
    EXPECT_LE(sd, most_sd);
  };
  near(impact["restitution"], 0.8651, 0.004);
  near(impact["space"]["friction"], 0.106767, 0.004);
  near(impact["after"]["omega_t_rad_s"], 118.84, 0.3);
  EXPECT_EQ(impact["friction"]["gravity_corrected"]["status"], "doubtful");
  EXPECT_NE(outcome.err.find("slips out of the picture's plane"), std::string::npos) << outcome.err;
  const CsvTable rows = clip.rows();
  const auto statuses = rows.text("status");
  EXPECT_LE(std::count(statuses.begin(), statuses.end(), "inconsistent"), 3);
}

TEST(Sphere, AThingThatIsNotRoundIsNoSphere) {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "turns");
  for (int k = 0; k < 6; ++k) {
    const double r = k % 2 == 0 ? 60 : 64;
    std::ofstream file(folder / ("turns/f" + std::to_string(k) + ".pgm"), std::ios::binary);
    file << "P5 180 180 255\n";
    for (int y = 0; y < 180; ++y) {
      for (int x = 0; x < 180; ++x) {
        const double inside = r - std::hypot(x - 90.3, y - 89.6);
        const double skin = 150 + 30 * std::sin(x / (5.0 + k)) * std::cos(y / (7.0 - k));
        const double level = 20 + (skin - 20) / (1 + std::exp(-2 * inside));
        file.put(static_cast<char>(static_cast<unsigned char>(level)));
      }
    }
  }
  ASSERT_TRUE(std::filesystem::exists(folder / "turns/f5.pgm"));
  const Outcome outcome =
      run_program("track " + quoted(folder / "turns") + " --fps 10 -o " + quoted(folder / "out"));
  EXPECT_NE(outcome.err.find("no sphere: the radius of its outline changes by"), std::string::npos)
      << outcome.err;
}

TEST(Sphere, WordsThatAreNoBodyAreRefused) {
  const SphereClip clip("--velocity-px 1,0 --spin-deg 0,0,1");
  const Outcome outcome = clip.track("--body cube");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("there are auto, sphere and disc"), std::string::npos) << outcome.err;
  EXPECT_EQ(clip.track("--body sphere --estimator ring").status, 2);
  EXPECT_EQ(clip.track("--body sphere --estimator field").status, 2);
}

TEST(Sphere, ASmallBallsTurnIsToldWithTheRimsRadius) {
  const SphereClip clip("--pattern a3 --velocity-px 0.31,-0.2 --spin-deg -0.36,-0.01,-1",
                        "--radius-px 30 --size 100x100 --frames 12");
  ASSERT_EQ(clip.track().status, 0);
  EXPECT_EQ(clip.summary()["body"]["kind"], "sphere");
}

}  // namespace
}  // namespace impactdic::testing
