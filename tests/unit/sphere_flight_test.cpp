// A sphere's flight solved as one, on rows made of an exact motion.
#include <gtest/gtest.h>
#include <impactdic/units.h>

#include <cmath>
#include <functional>
#include <random>

#include "host/impact/impact_phases.h"
#include "host/sphere/source_response.h"

namespace impactdic::testing {
namespace {

constexpr double kRadius_px = 115;

struct Flight {
  double vx = 0.73, vy = 0.41;                              // px/frame, y up
  double rot_x_deg = 1.1, rot_y_deg = -0.8, rot_deg = 0.6;  // a frame
  double radius_error_px = 0;
  double nearness_error = 0, nearness_sd = 0;  // of the radius over the camera's distance
  double circle_px = 0.01, step_px = 0.002, turn_deg = 0.0012;  // noise
  int frames = 60;
};

// The motion of a row, step and turn across it bent by what is told wrong, and erring together as
// they do in pictures.
void put_motion(const Flight& f, const sphere::SourceResponse& bent, double radius_sd_px,
                const std::function<double()>& deviate, TrackRow& row) {
  constexpr double kCorrelation = 0.94;
  constexpr std::size_t r = sphere::kToRadius, k = sphere::kToNearness;
  using ToSources = sphere::SourceResponse::ToSources;
  const double rest = std::sqrt(1 - kCorrelation * kCorrelation);
  const auto wrong = [&](const ToSources& by) {
    return by[r] * f.radius_error_px + by[k] * f.nearness_error;
  };
  const double across = deviate(), down = deviate();
  row.dx_px = f.vx + f.step_px * across + wrong(bent.dx);
  row.dy_px = -f.vy + f.step_px * down + wrong(bent.dy);
  row.rot_y_deg = f.rot_y_deg + wrong(bent.rot_y) * kDegPerRad -
                  f.turn_deg * (kCorrelation * across + rest * deviate());
  row.rot_x_deg = f.rot_x_deg + wrong(bent.rot_x) * kDegPerRad -
                  f.turn_deg * (kCorrelation * down + rest * deviate());
  row.rot_deg = f.rot_deg + bent.rot_z[k] * f.nearness_error * kDegPerRad + 0.0004 * deviate();
  row.rot_sd_deg = std::hypot(0.0004, bent.rot_z[k] * f.nearness_sd * kDegPerRad);
  const double own = -kCorrelation * f.step_px * f.turn_deg * kRadPerDeg;
  const auto state = [&](const ToSources& step, const ToSources& turn, double& step_sd,
                         double& turn_sd_deg, double& correlation) {
    const double near = f.nearness_sd;
    step_sd = std::hypot(f.step_px, step[r] * radius_sd_px, step[k] * near);
    const double turn_sd =
        std::hypot(f.turn_deg * kRadPerDeg, turn[r] * radius_sd_px, turn[k] * near);
    turn_sd_deg = turn_sd * kDegPerRad;
    correlation =
        (own + step[r] * turn[r] * radius_sd_px * radius_sd_px + step[k] * turn[k] * near * near) /
        (step_sd * turn_sd);
  };
  state(bent.dx, bent.rot_y, row.dx_sd_px, row.rot_y_sd_deg, row.dx_rot_y_corr);
  state(bent.dy, bent.rot_x, row.dy_sd_px, row.rot_x_sd_deg, row.dy_rot_x_corr);
}

// What `track` would say of it; the optical axis is where the ball begins.
std::vector<TrackRow> rows_of(const Flight& f, unsigned seed, double radius_sd_px) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 1);
  const auto deviate = [&] { return normal(random); };
  std::vector<TrackRow> rows;
  for (int i = 0; i < f.frames; ++i) {
    TrackRow row;
    row.frame = i;
    row.status = TrackStatus::kOk;
    row.circle_ok = true;
    row.cx_px = 200 + f.vx * i + f.circle_px * deviate();
    row.cy_px = 250 - f.vy * i + f.circle_px * deviate();
    row.r_px = kRadius_px;
    row.cx_sd_px = row.cy_sd_px = f.circle_px;
    row.r_sd_px = 0.02;
    row.motion_ok = i + 1 < f.frames;
    if (row.motion_ok) {
      const auto bent = sphere::source_response(
          {{f.rot_x_deg * kRadPerDeg, f.rot_y_deg * kRadPerDeg, f.rot_deg * kRadPerDeg},
           kRadius_px,
           {f.vx * i, -f.vy * i},
           {f.vx * (i + 1), -f.vy * (i + 1)}});
      put_motion(f, bent, radius_sd_px, deviate, row);
    }
    rows.push_back(row);
  }
  return rows;
}

impact::ImpactOptions options_of(double radius_sd_px) {
  impact::ImpactOptions options;
  options.gravity = 0;
  options.radius_px = Measured{kRadius_px, radius_sd_px};
  return options;
}

// Errors over what is stated of them.
class Scores {
 public:
  void add(const Measured& found, double wanted) {
    squares_ += std::pow((found.value - wanted) / found.sd, 2);
    ++count_;
  }
  double rms() const { return std::sqrt(squares_ / count_); }

 private:
  double squares_ = 0;
  int count_ = 0;
};

TEST(SphereFlight, CentresShowWhatTheRadiusDoesToStepsAndTurns) {
  constexpr double kRadiusSd_px = 0.1;
  Flight truth;
  truth.radius_error_px = 0.15;  // 0.3 % of each turn
  Scores scores;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const auto rows = rows_of(truth, seed, kRadiusSd_px);
    const FlightMotion flight = impact::analyse_impact(rows, options_of(kRadiusSd_px)).flight;
    ASSERT_EQ(flight.last, rows.size() - 1);
    scores.add(flight.vx, truth.vx);
    scores.add(flight.vy, truth.vy);
    scores.add(flight.spin_t, truth.rot_x_deg * kRadPerDeg);
    scores.add(flight.spin_n, truth.rot_y_deg * kRadPerDeg);
    scores.add(flight.spin, truth.rot_deg * kRadPerDeg);
    // A third of what the steps alone would be wrong by.
    EXPECT_NEAR(flight.spin_t.value * kDegPerRad, truth.rot_x_deg, 0.0012);
  }
  EXPECT_LT(scores.rms(), 1.2);
  EXPECT_GT(scores.rms(), 0.4);  // the model's own part is here no error
}

// What is not known of the distance is the same in all rows: no number of them makes it smaller.
TEST(SphereFlight, TheDistanceErrsAlikeInAllRows) {
  Flight flown;
  flown.nearness_sd = 0.005;
  std::mt19937 random(5);
  std::normal_distribution<double> deviate(0, flown.nearness_sd);
  double squares = 0, stated_deg = 0;
  constexpr int kFlights = 60;
  for (unsigned seed = 1; seed <= kFlights; ++seed) {
    flown.nearness_error = deviate(random);
    const auto rows = rows_of(flown, seed, 0.02);
    impact::ImpactOptions options = options_of(0.02);
    options.nearness_sd = flown.nearness_sd;
    options.axis_px = {200, 250};
    const FlightMotion flight = impact::analyse_impact(rows, options).flight;
    ASSERT_EQ(flight.last, rows.size() - 1);
    const auto score = [&](const Measured& found, double wanted_deg) {
      squares += std::pow((found.value * kDegPerRad - wanted_deg) / (found.sd * kDegPerRad), 2);
    };
    score(flight.spin_t, flown.rot_x_deg);
    score(flight.spin_n, flown.rot_y_deg);
    stated_deg += flight.spin_t.sd * kDegPerRad / kFlights;
  }
  EXPECT_NEAR(std::sqrt(squares / (2 * kFlights)), 1, 0.25);
  // The centres tell a part of it, as they do of the radius.
  flown.nearness_error = flown.nearness_sd = 0;
  const FlightMotion known =
      impact::analyse_impact(rows_of(flown, 1, 0.02), options_of(0.02)).flight;
  EXPECT_GT(stated_deg, 1.5 * known.spin_t.sd * kDegPerRad);
}

// Registers every frame against a keyframe, another one every eighth frame, as pictures do: both
// frames' noise, the keyframe's the same for all that lean on it, and what its circle and the
// radius are off by.
void add_keyframes(const Flight& f, unsigned seed, std::vector<TrackRow>& rows) {
  std::mt19937 random(seed);
  std::normal_distribution<double> deviate(0, 1);
  constexpr double kCorrelation = 0.94;
  const double rest = std::sqrt(1 - kCorrelation * kCorrelation), half = std::sqrt(0.5);
  struct Noise {
    double across, down, x, y, z;
  };
  std::vector<Noise> noise;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double across = half * deviate(random), down = half * deviate(random);
    noise.push_back({f.step_px * across, f.step_px * down,
                     -f.turn_deg * (kCorrelation * down + half * rest * deviate(random)),
                     -f.turn_deg * (kCorrelation * across + half * rest * deviate(random)),
                     half * 0.0004 * deviate(random)});
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::size_t key = i == 0 ? 0 : (i - 1) / 8 * 8;
    BodyPose& pose = rows[i].pose;
    pose.ok = true;
    pose.origin = 0;
    pose.keyframe = static_cast<std::int64_t>(key);
    if (i == 0) continue;
    const auto frames = static_cast<double>(i - key), at = static_cast<double>(key);
    const double off_x = rows[key].cx_px - 200 - f.vx * at;
    const double off_y = rows[key].cy_px - 250 + f.vy * at;
    const auto bent = sphere::source_response(
        {{frames * f.rot_x_deg * kRadPerDeg, frames * f.rot_y_deg * kRadPerDeg,
          frames * f.rot_deg * kRadPerDeg},
         kRadius_px,
         {},
         {}});
    const auto by = [&](const sphere::SourceResponse::ToSources& to) {
      return to[0] * off_x + to[1] * off_y + to[2] * f.radius_error_px;
    };
    const Noise &a = noise[i], &b = noise[key];
    pose.key_dx_px = frames * f.vx + by(bent.dx) + a.across - b.across;
    pose.key_dy_px = -frames * f.vy + by(bent.dy) + a.down - b.down;
    pose.key_rot_x_deg = frames * f.rot_x_deg + by(bent.rot_x) * kDegPerRad + a.x - b.x;
    pose.key_rot_y_deg = frames * f.rot_y_deg + by(bent.rot_y) * kDegPerRad + a.y - b.y;
    pose.key_rot_deg = frames * f.rot_deg + by(bent.rot_z) * kDegPerRad + a.z - b.z;
  }
}

TEST(SphereFlight, KeyframesKnowTheFlightBetterThanSteps) {
  constexpr double kRadiusSd_px = 0.05;
  Flight truth;
  truth.radius_error_px = 0.04;
  double squares = 0, keyed = 0, stepped = 0;
  int figures = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    auto rows = rows_of(truth, seed, kRadiusSd_px);
    const FlightMotion by_steps = impact::analyse_impact(rows, options_of(kRadiusSd_px)).flight;
    add_keyframes(truth, 100 + seed, rows);
    const FlightMotion flight = impact::analyse_impact(rows, options_of(kRadiusSd_px)).flight;
    ASSERT_EQ(flight.last, rows.size() - 1);
    const auto score = [&](const Measured& found, const Measured& before, double wanted) {
      squares += std::pow((found.value - wanted) / found.sd, 2);
      keyed += std::pow((found.value - wanted) / before.sd, 2);
      stepped += std::pow((before.value - wanted) / before.sd, 2);
      ++figures;
    };
    score(flight.vx, by_steps.vx, truth.vx);
    score(flight.vy, by_steps.vy, truth.vy);
    score(flight.spin_t, by_steps.spin_t, truth.rot_x_deg * kRadPerDeg);
    score(flight.spin_n, by_steps.spin_n, truth.rot_y_deg * kRadPerDeg);
    score(flight.spin, by_steps.spin, truth.rot_deg * kRadPerDeg);
  }
  // The model's own part is here no error.
  EXPECT_LT(std::sqrt(squares / figures), 1.2);
  EXPECT_GT(std::sqrt(squares / figures), 0.3);
  EXPECT_LT(keyed, 0.5 * stepped);
}

// Centres by turns err alike, here along a path of their own, and know a lamp's part of the rims.
TEST(SphereFlight, RimsTellThePathAndTurnsHowFarRimsLieOff) {
  constexpr double kLamp_px = 0.09, kDrift_px = 5e-4, kPlaced_px = 0.005;
  const Flight truth;
  Scores scores;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    auto rows = rows_of(truth, seed, 0.02);
    for (TrackRow& row : rows) row.cx_px += kLamp_px, row.cy_px -= kLamp_px;
    add_keyframes(truth, 100 + seed, rows);  // about these
    for (std::size_t i = 0; i < rows.size(); ++i) {
      TrackRow& row = rows[i];
      const double at = static_cast<double>(i), drift_px = kDrift_px * (at - 29.5);
      row.rim_off_x_px = row.cx_px - (200 + truth.vx * at + drift_px);
      row.rim_off_y_px = row.cy_px - (250 - truth.vy * at + drift_px);
      row.cx_px -= row.rim_off_x_px;
      row.cy_px -= row.rim_off_y_px;
      row.rim_x_sd_px = row.rim_y_sd_px = row.cx_sd_px;
      row.cx_sd_px = row.cy_sd_px = kPlaced_px;
    }
    const FlightMotion flight = impact::analyse_impact(rows, options_of(0.02)).flight;
    ASSERT_EQ(flight.last, rows.size() - 1);
    scores.add(flight.vx, truth.vx);
    scores.add(flight.vy, truth.vy);
    scores.add(flight.spin_t, truth.rot_x_deg * kRadPerDeg);
    scores.add(flight.spin_n, truth.rot_y_deg * kRadPerDeg);
  }
  EXPECT_LT(scores.rms(), 1.2);
}

// A circle that lies off the ball turns every pair's motion a little about the line of sight; the
// keyframes' are held against the path.
TEST(SphereFlight, TheSpinTowardsTheCameraIsThatOfKeyframes) {
  constexpr double kOff_deg = 0.0005;
  const Flight truth;
  auto rows = rows_of(truth, 3, 0.02);
  add_keyframes(truth, 103, rows);
  for (TrackRow& row : rows) row.rot_deg += kOff_deg;
  const FlightMotion flight = impact::analyse_impact(rows, options_of(0.02)).flight;
  ASSERT_EQ(flight.last, rows.size() - 1);
  EXPECT_NEAR(flight.spin.value * kDegPerRad, truth.rot_deg, 0.3 * kOff_deg);
}

TEST(SphereFlight, AKeyframeBeforeTheRowsTellsOnlyHowFramesMovedAmongThemselves) {
  const Flight truth;
  auto rows = rows_of(truth, 11, 0.05);
  add_keyframes(truth, 111, rows);
  for (std::size_t i = 1; i <= 8; ++i) {  // one that is not among the rows, somewhere else
    rows[i].pose.keyframe = -7;
    rows[i].pose.key_dx_px += 31;
    rows[i].pose.key_dy_px -= 12;
  }
  const FlightMotion flight = impact::analyse_impact(rows, options_of(0.05)).flight;
  ASSERT_EQ(flight.last, rows.size() - 1);
  EXPECT_NEAR(flight.vx.value, truth.vx, 4 * flight.vx.sd);
  EXPECT_NEAR(flight.vy.value, truth.vy, 4 * flight.vy.sd);
}

TEST(SphereFlight, AnOutlineThatGrowsTellsTheVelocityTowardsTheCamera) {
  constexpr double kDistance_px = 25 * kRadius_px, kNoise_px = 0.02, kTowards = 0.4;
  constexpr double kDrift_px = 0.03;  // over the flight: texture that turns under the rim
  double squares = 0;
  constexpr int kSeeds = 60;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    auto rows = rows_of(Flight{}, seed, 0.05);
    std::mt19937 random(1000 + seed);
    std::normal_distribution<double> deviate(0, kNoise_px);
    const double drift = std::normal_distribution<double>(0, kDrift_px)(random) / 59;
    const double ball_px = kRadius_px * std::sqrt(1 - 1 / (25.0 * 25.0));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double z = kTowards * (static_cast<double>(i) - 29.5);
      const double from = kDistance_px - z;  // f = D: a pixel is one where the flight's middle is
      rows[i].r_px = kDistance_px * ball_px / std::sqrt(from * from - ball_px * ball_px) +
                     deviate(random) + drift * static_cast<double>(i);
    }
    rows[20].r_px += 3;  // a wrong circle
    impact::ImpactOptions options = options_of(0.05);
    EXPECT_TRUE(std::isnan(impact::analyse_impact(rows, options).flight.vb.value));
    options.distance_px = Measured{kDistance_px, 0};
    const Measured towards = impact::analyse_impact(rows, options).flight.vb;
    squares += std::pow((towards.value - kTowards) / towards.sd, 2);
    EXPECT_LT(towards.sd, 0.02);
  }
  // 60 scores tell their rms to a tenth.
  EXPECT_NEAR(std::sqrt(squares / kSeeds), 1, 0.3);
}

TEST(SphereFlight, HoldsInTheSurfacesAxes) {
  const Flight truth;
  const auto rows = rows_of(truth, 3, 0.05);
  impact::ImpactOptions options = options_of(0.05);
  options.surface_angle_rad = 30 * kRadPerDeg;
  const FlightMotion flight = impact::analyse_impact(rows, options).flight;
  const double c = std::cos(options.surface_angle_rad), s = std::sin(options.surface_angle_rad);
  EXPECT_NEAR(flight.vx.value, truth.vx, 4 * flight.vx.sd);
  EXPECT_NEAR(flight.vt.value, c * truth.vx + s * truth.vy, 4 * flight.vt.sd);
  EXPECT_NEAR(flight.vn.value, -s * truth.vx + c * truth.vy, 4 * flight.vn.sd);
  EXPECT_NEAR(flight.spin_t.value * kDegPerRad, c * truth.rot_x_deg + s * truth.rot_y_deg,
              4 * flight.spin_t.sd * kDegPerRad);
  EXPECT_NEAR(flight.spin_n.value * kDegPerRad, -s * truth.rot_x_deg + c * truth.rot_y_deg,
              4 * flight.spin_n.sd * kDegPerRad);
}

TEST(SphereFlight, APathThatIsNoFlightIsNotReported) {
  auto rows = rows_of(Flight{}, 5, 0.05);
  for (std::size_t i = 0; i < rows.size(); ++i) {  // around a circle
    const double at = 2 * kPi * static_cast<double>(i) / static_cast<double>(rows.size());
    rows[i].cx_px = 200 + 60 * std::cos(at);
    rows[i].cy_px = 200 + 60 * std::sin(at);
  }
  EXPECT_EQ(impact::analyse_impact(rows, options_of(0.05)).flight.last, 0u);
}

TEST(SphereFlight, AFlatBallHasNoSpinOutOfThePlane) {
  auto rows = rows_of(Flight{}, 7, 0.05);
  for (TrackRow& row : rows) row.rot_x_deg = row.rot_y_deg = kNotMeasured;
  const FlightMotion flight = impact::analyse_impact(rows, options_of(0.05)).flight;
  ASSERT_EQ(flight.last, rows.size() - 1);
  EXPECT_NEAR(flight.spin.value * kDegPerRad, Flight{}.rot_deg, 4 * flight.spin.sd * kDegPerRad);
  EXPECT_TRUE(std::isnan(flight.spin_t.value));
}

}  // namespace
}  // namespace impactdic::testing
