// A compressed flat ball: what turns from one shape to another is not what its pictures show, and
// an error of its centre shows in its motion.
#include "host/motion/ball_shape.h"

#include <gtest/gtest.h>
#include <impactdic/units.h>

#include <Eigen/Dense>
#include <cmath>

#include "host/pipeline/rows/fill_row.h"

namespace impactdic::testing {
namespace {

using Eigen::Matrix2d;
using motion::BallShape;
using motion::Stretch;

// Image axes, y down, counter-clockwise on the screen.
Matrix2d turn_by(double rad) {
  const double c = std::cos(rad), s = std::sin(rad);
  return Matrix2d{{c, s}, {-s, c}};
}

Matrix2d stretch_of(const BallShape& shape) {
  return Matrix2d{{1 + shape.e1, shape.e2}, {shape.e2, 1 - shape.e1}};
}

// What an affine registration finds of a ball that goes from one shape to another and turns.
BallMotion registered(const BallShape& first, const BallShape& second, double turn_rad) {
  const Matrix2d shown = stretch_of(second) * turn_by(turn_rad) * stretch_of(first).inverse();
  const double angle = std::atan2(shown(0, 1) - shown(1, 0), shown(0, 0) + shown(1, 1));
  const Matrix2d strain = turn_by(-angle) * shown - Matrix2d::Identity();
  BallMotion motion{};
  motion.rot_rad = static_cast<float>(angle);
  motion.exx = static_cast<float>(strain(0, 0));
  motion.exy = static_cast<float>(strain(0, 1));
  motion.eyy = static_cast<float>(strain(1, 1));
  return motion;
}

constexpr double kTurn_rad = 0.06;
constexpr BallShape kFirst{0.045, 0.012, 1e-4}, kSecond{0.02, -0.015, 1e-4};

TEST(BallShape, ACompressedBallsTurnIsFoundFromItsShape) {
  const BallMotion shown = registered(kFirst, kSecond, kTurn_rad);
  EXPECT_GT(std::abs(shown.rot_rad - kTurn_rad), 5e-5);
  dic::RigidMotion motion;
  motion.rot_rad = shown.rot_rad;
  motion::correct_turn(kFirst, shown, motion);
  EXPECT_NEAR(motion.rot_rad, kTurn_rad, 2e-7);  // single precision
}

// To second order of the strains, which is what is asked of it: the outline missed all of it.
TEST(BallShape, TheNextOutlineAndTheStrainTellTheShapeBefore) {
  for (const BallShape& second : {kSecond, kFirst}) {
    const BallMotion shown = registered(kFirst, second, kTurn_rad);
    const BallShape before = motion::shape_before(second, shown);
    EXPECT_NEAR(before.e1, kFirst.e1, 2e-3);
    EXPECT_NEAR(before.e2, kFirst.e2, 2e-3);
    EXPECT_NEAR(before.sd, second.sd, 1e-9);
    // Which leaves a twentieth of what the outline would have made of the turn.
    const double missed = std::abs(shown.rot_rad - kTurn_rad);
    dic::RigidMotion motion;
    motion.rot_rad = shown.rot_rad;
    motion::correct_turn(before, shown, motion);
    EXPECT_LT(std::abs(motion.rot_rad - kTurn_rad), missed / 20);
  }
}

TEST(BallShape, AnErrorOfTheCentreIsInTheMotionOfABallThatIsCompressed) {
  constexpr double kSdX_px = 0.02, kSdY_px = 0.05;
  const auto sd_of = [&](double turn_rad, const Stretch& stretch) {
    TrackRow row;
    row.circle_ok = true;
    row.cx_sd_px = kSdX_px, row.cy_sd_px = kSdY_px;
    dic::RigidMotion motion;
    motion.ok = true;
    motion.rot_rad = turn_rad;
    pipeline::set_motion(row, motion, stretch);
    return Eigen::Vector2d(row.dx_sd_px, row.dy_sd_px);
  };
  for (const Stretch& stretch : {Stretch{}, Stretch{0.03, 0.01, -0.06}}) {
    // The displacement of a point that is off by the error, less the centre's.
    const Matrix2d strain{{1 + stretch.xx, stretch.xy}, {stretch.xy, 1 + stretch.yy}};
    const Matrix2d moved = turn_by(kTurn_rad) * strain - Matrix2d::Identity();
    const Eigen::Vector2d sd = sd_of(kTurn_rad, stretch);
    EXPECT_NEAR(sd.x(), std::hypot(moved(0, 0) * kSdX_px, moved(0, 1) * kSdY_px), 1e-12);
    EXPECT_NEAR(sd.y(), std::hypot(moved(1, 0) * kSdX_px, moved(1, 1) * kSdY_px), 1e-12);
  }
}

// A thing without texture is as doubtful in its last frame as before.
TEST(BallShape, TheLastRowGoesWithTheOneBeforeIt) {
  TrackRow before;
  EXPECT_EQ(pipeline::status_behind(before), TrackStatus::kNoBall);
  before.circle_ok = true;
  before.status = TrackStatus::kOk;
  EXPECT_EQ(pipeline::status_behind(before), TrackStatus::kLastFrame);
  for (const TrackStatus status : {TrackStatus::kNoTexture, TrackStatus::kLowCorrelation}) {
    before.status = status;
    EXPECT_EQ(pipeline::status_behind(before), status);
  }
}

// Of a sphere taken for a disc, a part of what it turns out of the picture shows as a turn in it.
TEST(BallShape, AnUnseenTiltIsInTheTurnOfABallThatIsTakenForFlat) {
  TrackRow row, next;
  row.motion_ok = row.circle_ok = next.circle_ok = true;
  row.r_px = 133;
  row.dx_sd_px = row.dy_sd_px = 0.001;
  row.rot_sd_deg = 0.003;
  row.cx_sd_px = 0.4, row.cy_sd_px = 0.5;
  next.cx_sd_px = 0.3, next.cy_sd_px = 0.5;
  pipeline::doubt_motion(row, next);
  EXPECT_NEAR(row.dx_sd_px, 0.5, 1e-12);
  EXPECT_NEAR(row.dy_sd_px, std::sqrt(0.5), 1e-12);
  // A tilt of 0.56 degrees moves the picture by as much as the circles leave open.
  const double tilt_rad = std::hypot(0.5, std::sqrt(0.5)) * 1.5 / row.r_px;
  EXPECT_NEAR(row.rot_sd_deg, std::hypot(0.003, 0.13 * tilt_rad * kDegPerRad), 1e-12);
}

}  // namespace
}  // namespace impactdic::testing
