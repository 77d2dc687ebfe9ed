// The slopes of a rim's outline, of a line's places and of the rim's levels against central finite
// differences.
#include <gtest/gtest.h>
#include <impactdic/units.h>

#include <cmath>
#include <random>
#include <vector>

#include "host/circle/rim/rim_cast.h"
#include "host/circle/rim/rim_levels.h"
#include "host/circle/rim/rim_model.h"
#include "tests/support/rim_reference.h"

namespace impactdic {
namespace {

using circle::kSamples;

constexpr double kStep_px = 1.3;

// Distance from the old centre to a rim in the direction `angle`.
double distance_to(const circle::Rim& rim, double angle) {
  double low = 0.5 * rim.r, high = 2 * rim.r;
  for (int pass = 0; pass < 60; ++pass) {
    const double at = 0.5 * (low + high);
    const double x = at * std::cos(angle) - rim.cx, y = at * std::sin(angle) - rim.cy;
    const double way = std::atan2(y, x);
    (std::hypot(x, y) < rim.radius_at(std::cos(2 * way), std::sin(2 * way)) ? low : high) = at;
  }
  return low;
}

TEST(RimSlopes, OfTheRimByItsFiveParameters) {
  constexpr double h = 1e-3;
  for (double angle = 0.1; angle < 6.2; angle += 0.7) {
    const double slopes[5] = {std::cos(angle), std::sin(angle), 1, std::cos(2 * angle),
                              std::sin(2 * angle)};
    for (int m = 0; m < 5; ++m) {
      circle::Rim more{0, 0, 60}, less = more;
      double circle::Rim::*const parts[5] = {&circle::Rim::cx, &circle::Rim::cy, &circle::Rim::r,
                                             &circle::Rim::e1, &circle::Rim::e2};
      more.*parts[m] += h;
      less.*parts[m] -= h;
      EXPECT_NEAR((distance_to(more, angle) - distance_to(less, angle)) / (2 * h), slopes[m], 1e-6)
          << angle << m;
    }
  }
}

constexpr int kSide = 200;

// A 16-bit picture of something that changes with the place.
template <typename Level>
Frame picture(const Level& level) {
  Frame frame;
  frame.type = PixelType::kU16;
  frame.u16 = Image<std::uint16_t>(kSide, kSide);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      frame.u16.view()(x, y) = static_cast<std::uint16_t>(std::lround(level(x, y)));
    }
  }
  return frame;
}

// On a picture whose grey is the distance from the rim, a line reads the excesses of its samples.
// Their places are right to second order of the excess: x³/R² is left, and less of higher order.
TEST(RimSlopes, OfALinesPlacesByTheExcess) {
  for (const double e : {0.0, 1.5}) {
    const circle::Rim rim{98.3, 101.7, 70, e, -0.4 * e};
    const Frame frame = picture([&](int x, int y) {
      const double dx = x - rim.cx, dy = y - rim.cy, angle = std::atan2(dy, dx);
      const double radial =
          std::hypot(dx, dy) - rim.radius_at(std::cos(2 * angle), std::sin(2 * angle));
      // The normal's distance is shorter by the cosine of its angle to the ray.
      const double turn =
          2 * (-rim.e1 * std::sin(2 * angle) + rim.e2 * std::cos(2 * angle)) / rim.r;
      return 30000 + 400 * radial * std::cos(turn);
    });
    const auto third_order = [&](double excess) {
      const double x = std::abs(excess) / rim.r;
      return 0.006 + rim.r * x * x * x * (1.3 + x);
    };
    circle::CastLines lines;
    circle::cast_lines(frame, rim, {circle::Polarity::kBright, kStep_px, 2000, 1}, lines);
    ASSERT_GT(lines.size(), 300);
    for (int i = 0; i < lines.size(); ++i) {
      for (int k = 0; k < kSamples; ++k) {
        const double excess = (k - circle::kInside) * kStep_px;
        EXPECT_NEAR((lines.level[i].v[k] - 30000) / 400, excess, third_order(excess))
            << i << ' ' << k;
      }
    }
    ASSERT_GT(lines.deep_line.size(), 300u);
    for (std::size_t i = 0; i < lines.deep_line.size(); ++i) {
      for (int k = 0; k < circle::kDeep; ++k) {
        const double excess = -(circle::kInside + 1 + k) * kStep_px;
        EXPECT_NEAR((lines.deep_level[i].v[k] - 30000) / 400, excess, third_order(excess))
            << i << ' ' << k;
      }
    }
  }
}

// Each coefficient of the paint's level by itself, on a ball that shows it.
TEST(RimSlopes, OfTheLevelsByTheirCoefficients) {
  const circle::Rim rim{98.3, 101.7, 70};
  const double base[5] = {30000, 0, 0, 0, 0};
  const auto levels_of = [&](const double(&w)[5]) {
    const Frame frame = picture([&](int x, int y) {
      const double u = (x - rim.cx) / rim.r, v = (y - rim.cy) / rim.r;
      const double paint = w[0] + w[1] * u + w[2] * v + w[3] * (u * u - v * v) + w[4] * 2 * u * v;
      const double inside = 0.5 * std::erfc((std::hypot(u, v) - 1) * rim.r / std::sqrt(2.0));
      return 4000 + inside * (paint - 4000);
    });
    circle::LineTrace trace;
    circle::trace_lines(frame, rim, {circle::Polarity::kBright, 1, 720}, trace);
    EXPECT_GT(trace.lines.size(), 300u);
    return trace.levels;
  };
  const auto plain = levels_of(base);
  for (const float ground : plain.ground) EXPECT_NEAR(ground, 4000, 60);
  for (int m = 0; m < 5; ++m) {
    double more[5] = {30000, 0, 0, 0, 0};
    more[m] += 1500;
    const auto levels = levels_of(more);
    for (int n = 0; n < 5; ++n) {
      EXPECT_NEAR((levels.light[n] - plain.light[n]) / 1500, m == n ? 1 : 0, 0.08) << m << n;
    }
    // And the level at places is linear in the coefficient.
    std::array<float, 5> only{};
    only[m] = 1;
    for (const auto& [x, y] : {std::pair{0.9f, 0.1f}, {-0.4f, 0.7f}, {0.2f, -0.8f}}) {
      const float basis[5] = {1, x, y, x * x - y * y, 2 * x * y};
      EXPECT_FLOAT_EQ(circle::light_at(only, x, y), basis[m]) << m;
    }
  }
}

}  // namespace
}  // namespace impactdic
