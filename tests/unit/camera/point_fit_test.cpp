#include "host/camera/calibrate/point_fit.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "tests/support/camera/rendered_calibration.h"

namespace impactdic {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using P = CameraParameter;

camera::BoardSight sight_of(const Camera& view) {
  camera::LensValues lens;
  camera::Pose pose;
  for (int i = 0; i < camera::kLensValues; ++i) lens[i] = view.values[static_cast<std::size_t>(i)];
  for (int i = 0; i < camera::kPoseValues; ++i) {
    pose[i] = view.values[static_cast<std::size_t>(camera::kLensValues + i)];
  }
  return {lens, pose};
}

// Information on a shift of the picture about each of the target's points, of all pixels that lie
// nearer to it than to its neighbours (Kay 1993, Eq. 3.31), by differences of rendered pictures:
// what no estimate that is right on average can beat, and none with unknown blur and light reaches.
std::vector<Matrix2d> bounds(const Camera& view, const CalibrateRequest& request,
                             const testing::TargetScene& scene) {
  const testing::TargetPattern pattern(request);
  constexpr double kStep_px = 0.1;
  cv::Mat slopes[2];
  for (int axis = 0; axis < 2; ++axis) {
    Camera plus = view, minus = view;
    const P centre = axis == 0 ? P::kCx : P::kCy;
    plus[centre] += kStep_px, minus[centre] -= kStep_px;
    slopes[axis] = (testing::render_levels(plus, pattern, scene) -
                    testing::render_levels(minus, pattern, scene)) /
                   (2 * kStep_px);
  }
  const double variance = scene.noise * scene.noise + 1.0 / 12;  // grey levels are rounded
  const camera::BoardSight sight = sight_of(view);
  const camera::BoardPoints board = camera::board_points(request);
  std::vector<Matrix2d> found(board.size(), Matrix2d::Zero());
  const double pitch = request.pitch_mm * 1e-3;
  const int columns = static_cast<int>(std::lround(board.back().x() / pitch)) + 1;
  const int rows = static_cast<int>(board.size()) / columns;
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      const Vector2d at = sight.to_board({x, y}) / pitch;
      const auto column = std::lround(at.x()), row = std::lround(at.y());
      if (column < 0 || row < 0 || column >= columns || row >= rows) continue;
      const Vector2d slope(slopes[0].at<float>(y, x), slopes[1].at<float>(y, x));
      found[static_cast<std::size_t>(row * columns + column)] +=
          slope * slope.transpose() / variance;
    }
  }
  for (Matrix2d& information : found) information = information.inverse().eval();
  return found;
}

struct Scatter {
  double error = 0, stated = 0, bound = 0, over_stated = 0;  // rms along one axis, px
  Vector2d mean{0, 0};
  std::size_t points = 0;
};

// Every point of one picture, from a start that is some tenths of a pixel off.
Scatter scatter_of(const Camera& view, const CalibrateRequest& request,
                   const testing::TargetScene& scene, const std::vector<Matrix2d>& bound) {
  const Frame frame = testing::render_target(view, testing::TargetPattern(request), scene, 4);
  const Image<float> levels = frame.to_float();
  const camera::BoardSight sight = sight_of(view);
  const camera::PointPattern pattern(request);
  const camera::BoardPoints board = camera::board_points(request);
  Scatter sum;
  for (std::size_t i = 0; i < board.size(); ++i) {
    const Vector2d truth = sight.to_picture(board[i]);
    // All that is near the point is seen.
    constexpr double kMargin_px = 18;
    const Vector2d opposite(view.width - 1 - truth.x(), view.height - 1 - truth.y());
    if (truth.cwiseMin(opposite).minCoeff() < kMargin_px) continue;
    const auto found =
        camera::fit_point(levels, sight, pattern, {i, truth + Vector2d(0.3, -0.2)}, board[i]);
    if (!found) continue;
    const Vector2d off = found->at_px - truth;
    ++sum.points;
    sum.mean += off;
    sum.error += off.squaredNorm() / 2;
    sum.stated += found->covariance.trace() / 2;
    sum.over_stated += off.dot(found->covariance.inverse() * off) / 2;
    if (!bound.empty()) sum.bound += bound[i].trace() / 2;
  }
  const auto n = static_cast<double>(sum.points);
  sum.mean /= n;
  for (double* one : {&sum.error, &sum.stated, &sum.bound, &sum.over_stated}) {
    *one = std::sqrt(*one / n);
  }
  return sum;
}

class PointFit : public ::testing::TestWithParam<CalibrationTarget> {
 protected:
  CalibrateRequest request_ = testing::rendered_target(GetParam());
  // One nearly square, others tilted.
  std::vector<Camera> views_ = testing::random_calibration(request_, 4, 11).views;
};

TEST_P(PointFit, ScattersAsThePicturesNoiseMakesItMust) {
  const testing::TargetScene scenes[] = {
      {}, {60, 130, 3, 1.2, 0.3, 0.1}, {20, 240, 1, 0.5, 0, 0.2}, {40, 200, 6, 0.8, 0, 0}};
  for (std::size_t i = 0; i < 4; ++i) {
    const Scatter found =
        scatter_of(views_[i], request_, scenes[i], bounds(views_[i], request_, scenes[i]));
    EXPECT_GE(found.points, 30u);
    std::printf("%zu: %zu points err by %.5f px, stated %.5f, bound %.5f; over stated %.3f\n", i,
                found.points, found.error, found.stated, found.bound, found.over_stated);
    // 60 to 120 numbers: their scatter is known to 7 to 9 %. Unknown light and blur cost some,
    // slopes of light within a small dot more: 1.75 times, as the stated deviations say.
    EXPECT_LT(found.error, (GetParam() == CalibrationTarget::kDots ? 2.1 : 1.4) * found.bound);
    EXPECT_NEAR(found.over_stated, 1, 0.25);
  }
}

// What light that falls off, a curve of grey levels and ink that runs do is no error of the place.
TEST_P(PointFit, LightThatFallsOffMovesNoPoint) {
  const testing::TargetScene scene{40, 200, 0, 0.6, 0.5, 0.3};
  const Scatter found = scatter_of(views_[1], request_, scene, {});
  // Light that falls off is blurred, too: by blur² times its relative slope, 0.001 px.
  EXPECT_LT(found.mean.norm(), 0.003);
  EXPECT_LT(found.error, 0.005);
}

// The size of dots or markers is not quite what was told.
TEST_P(PointFit, AWrongSizeOfDotsOrMarkersMovesNoPoint) {
  CalibrateRequest told = request_;
  told.dot_mm *= 0.8;
  told.marker_mm = 7.2;  // 7.5
  const Camera& view = views_[2];
  const Frame frame =
      testing::render_target(view, testing::TargetPattern(request_), {40, 200, 0, 0.6, 0, 0}, 4);
  const Image<float> levels = frame.to_float();
  const camera::BoardSight sight = sight_of(view);
  const camera::BoardPoints board = camera::board_points(request_);
  Vector2d mean(0, 0);
  double worst = 0;
  for (std::size_t i = 0; i < board.size(); ++i) {
    const Vector2d truth = sight.to_picture(board[i]);
    const auto found =
        camera::fit_point(levels, sight, camera::PointPattern(told), {i, truth}, board[i]);
    if (!found) continue;
    worst = std::max(worst, (found->at_px - truth).norm());
    mean += (found->at_px - truth) / static_cast<double>(board.size());
  }
  EXPECT_LT(mean.norm(), 0.003);
  EXPECT_LT(worst, 0.03);
}

TEST_P(PointFit, NothingWhereNothingIsSeen) {
  const camera::BoardSight sight = sight_of(views_[0]);
  const camera::PointPattern pattern(request_);
  const camera::BoardPoints board = camera::board_points(request_);
  const Vector2d at = sight.to_picture(board[20]);
  const Image<float> blank(views_[0].width, views_[0].height, 90.0F);
  EXPECT_FALSE(camera::fit_point(blank, sight, pattern, {20, at}, board[20]));
  // Out of the picture.
  const Vector2d aside = board[20] + Vector2d(1, 1);
  EXPECT_FALSE(camera::fit_point(blank, sight, pattern, {20, sight.to_picture(aside)}, aside));
}

INSTANTIATE_TEST_SUITE_P(All, PointFit,
                         ::testing::Values(CalibrationTarget::kCheckerboard,
                                           CalibrationTarget::kCharuco, CalibrationTarget::kDots),
                         [](const auto& info) { return std::string(to_string(info.param)); });

}  // namespace
}  // namespace impactdic
