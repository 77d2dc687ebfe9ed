// Rulers in rendered pictures: the scale by their ticks.
#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <Eigen/Core>
#include <cmath>
#include <opencv2/core.hpp>
#include <random>

#include "host/camera/calibrate/calibrate_points.h"
#include "host/camera/calibrate/ticks.h"

namespace impactdic {
namespace {

using Eigen::Vector2d;

// A ruler of ticks along one edge, each fifth and tenth longer, with blocks for digits.
struct Ruler {
  Vector2d origin{60, 220};  // of the first tick, px
  double angle = 0;          // of the ruler, from x towards y
  double pitch_px = 6.7;
  int ticks = 61;
  double tick_width = 0.3, tick_length = 3;  // pitches
  double lens = 0;                           // share by which the pitch grows over the ruler
  bool bright = false;                       // ticks on a dark ruler
};

// 0 … 1: how much ink is seen at a place of the ruler, in pitches from its first tick and its edge.
double ink(const Ruler& ruler, double along, double across) {
  const double length = (ruler.ticks - 1);
  along -= ruler.lens * along * (along - length) / (2 * length);
  const int tick = static_cast<int>(std::lround(along));
  if (tick < 0 || tick >= ruler.ticks || across < 0) return 0;
  const double reach = ruler.tick_length * (tick % 10 == 0 ? 2 : tick % 5 == 0 ? 1.5 : 1);
  if (across < reach) return std::abs(along - tick) < ruler.tick_width / 2 ? 1 : 0;
  const bool digit = tick % 10 <= 1 && across > reach + 1 && across < reach + 3;
  return digit && std::fmod(std::abs(2.3 * along + 1.1 * across), 1.0) < 0.5 ? 1 : 0;
}

cv::Mat render(const Ruler& ruler, unsigned seed, cv::Size size = {640, 480}) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 2);
  cv::Mat picture(size, CV_8U);
  constexpr int kSub = 5;
  const Vector2d x_axis(std::cos(ruler.angle), std::sin(ruler.angle));
  const Vector2d y_axis(-x_axis.y(), x_axis.x());
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      double inked = 0, on = 0;
      for (int k = 0; k < kSub * kSub; ++k) {
        const Vector2d off((k % kSub + 0.5) / kSub - 0.5, (k / kSub + 0.5) / kSub - 0.5);
        const Vector2d at = (Vector2d(x, y) + off - ruler.origin) / ruler.pitch_px;
        const double along = at.dot(x_axis), across = at.dot(y_axis);
        on += across > 0 && across < 5 * ruler.tick_length && along > -4 && along < ruler.ticks + 3;
        inked += ink(ruler, along, across);
      }
      constexpr double kAll = kSub * kSub;
      const double body = ruler.bright ? 50 : 190, mark = ruler.bright ? 200 : 40, behind = 110;
      const double shade = 0.9 + 0.2 * x / size.width;
      const double grey = behind + (on / kAll) * (body - behind) + (inked / kAll) * (mark - body);
      picture.at<std::uint8_t>(y, x) =
          cv::saturate_cast<std::uint8_t>(grey * shade + noise(random));
    }
  }
  return picture;
}

CalibrateRequest request_of_mm() {
  CalibrateRequest request;
  request.pictures = {"ruler"};
  request.target = CalibrationTarget::kRuler;
  request.pitch_mm = 1;
  request.validate();
  return request;
}

TEST(Ruler, ItsTicksGiveTheScale) {
  struct Case {
    double angle, pitch, width;
    int ticks;
    bool bright;
  };
  for (const Case& one : {Case{0.0, 6.7, 0.3, 61, false}, Case{0.31, 5.2, 0.3, 71, false},
                          Case{-0.2, 12.4, 0.15, 31, true}, Case{1.45, 9.3, 0.25, 21, false}}) {
    Ruler ruler;
    ruler.angle = one.angle, ruler.pitch_px = one.pitch, ruler.tick_width = one.width;
    ruler.ticks = one.ticks, ruler.bright = one.bright;
    if (one.angle > 1) ruler.origin = {320, 60};
    const CalibrateResult found =
        camera::calibrate_ticks(request_of_mm(), "ruler", render(ruler, 1));
    const double truth = 1e-3 / one.pitch;
    EXPECT_NEAR(found.metre_per_px.value, truth, 4 * found.metre_per_px.sd) << one.angle;
    EXPECT_LT(found.metre_per_px.sd, 5e-4 * truth) << one.angle;
    EXPECT_GE(static_cast<int>(found.points.size()), one.ticks - 2) << one.angle;
    EXPECT_NE(found.verdict[0].find("is it what the ruler shows?"), std::string::npos);
    found.camera.validate();
  }
}

TEST(Ruler, AnUnevenPitchIsSaidAndPartOfTheDeviation) {
  Ruler ruler;
  ruler.lens = 0.02;
  const CalibrateResult found = camera::calibrate_ticks(request_of_mm(), "ruler", render(ruler, 1));
  const double truth = 1e-3 / ruler.pitch_px;
  EXPECT_NEAR(found.metre_per_px.sd, 0.02 / std::sqrt(12.0) * truth, 0.3 * 0.006 * truth);
  EXPECT_NEAR(found.metre_per_px.value, truth, 2 * found.metre_per_px.sd);
  EXPECT_NE(found.verdict.back().find("the pitch grows"), std::string::npos);
}

TEST(Ruler, ThePitchIsThatOfTheShortTicks) {
  Ruler ruler;
  ruler.tick_width = 0.2, ruler.pitch_px = 8, ruler.ticks = 51;
  const auto row = camera::find_ticks(render(ruler, 1));
  ASSERT_TRUE(row);
  EXPECT_NEAR(row->pitch_px, 8, 0.05);
}

// Speckles, a still wall and a gradient hold no even row.
TEST(Ruler, WhereThereIsNoneNoneIsFound) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    std::mt19937 random(seed);
    cv::Mat picture(300, 400, CV_8U, cv::Scalar(200));
    std::uniform_int_distribution<int> x(0, 399), y(0, 299), size(2, 6);
    const int speckles = seed == 4 ? 0 : 1500;
    for (int k = 0; k < speckles; ++k) {
      const int r = size(random), cx = x(random), cy = y(random);
      for (int py = std::max(0, cy - r); py < std::min(300, cy + r); ++py) {
        for (int px = std::max(0, cx - r); px < std::min(400, cx + r); ++px) {
          if (std::hypot(px - cx, py - cy) < r) picture.at<std::uint8_t>(py, px) = 40;
        }
      }
    }
    EXPECT_THROW(camera::calibrate_ticks(request_of_mm(), "wall", picture), InvalidArgument)
        << seed;
  }
}

}  // namespace
}  // namespace impactdic
