// The ball at one instant, and the samples of some pixel rows. Internal to the renderer.
#pragma once

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "sim/speckle/render.h"

namespace impactdic::sim::speckle {

inline constexpr int kExtraTaps = 6;  // of the pixel rule beyond the pixel's own samples

struct Vec {
  double x, y;
};

// Direction on the screen (y down) of an angle counter-clockwise from image-right.
inline Vec direction(double angle_deg) {
  return {std::cos(angle_deg * kRadPerDeg), -std::sin(angle_deg * kRadPerDeg)};
}

struct Span {
  double first, last;
  bool empty() const { return !(first < last); }
};

inline Span meet(Span a, Span b) { return {std::max(a.first, b.first), std::min(a.last, b.last)}; }

// Where |offset + slope x| <= half.
inline Span strip(double offset, double slope, double half) {
  if (slope == 0) return std::abs(offset) <= half ? Span{-1e30, 1e30} : Span{1, 0};
  const double a = (-half - offset) / slope, b = (half - offset) / slope;
  return {std::min(a, b), std::max(a, b)};
}

// The compressed ball's own (unturned) axes: u = A⁻¹ (x − centre), A⁻¹ = (m00 m01; m01 m11).
// Squared length there: kxx dx² + 2 kxy dx dy + kyy dy².
struct BallRenderer::Placed {
  double cx, cy, weight;
  double m00, m01, m11;
  double kxx, kxy, kyy;
  std::vector<Vec> discs;  // centres on the screen
  struct Line {
    Vec centre, along;  // on the screen; direction in the unturned axes
  };
  std::vector<Line> lines;
  double shade0, shade_x, shade_y;  // light = shade0 + shade_x · x + shade_y · y

  // Columns of a row `dy` below a centre that lie within `radius` of it, as offsets from it.
  Span chord(double dy, double radius) const {
    const double root = kxy * kxy * dy * dy - kxx * (kyy * dy * dy - radius * radius);
    if (!(root > 0)) return {1, 0};
    const double half = std::sqrt(root) / kxx, middle = -kxy * dy / kxx;
    return {middle - half, middle + half};
  }
  double squared(double dx, double dy) const {
    return (kxx * dx + 2 * kxy * dy) * dx + kyy * dy * dy;
  }
  double distance(double dx, double dy) const { return std::sqrt(std::max(0.0, squared(dx, dy))); }
};

// Samples of pixel rows first … last − 1 and columns left … right − 1, with those that the pixel
// rule takes from beyond. Sample g of the picture lies at (g + 1/2) / per_pixel − 1/2.
struct BallRenderer::Band {
  int first, last, left, right, per_pixel;
  std::vector<double> y, x;  // sample positions, px
  std::vector<float> clear;  // ∏(1 − S_i), (samples in y, samples in x)

  Band(int first_row, int last_row, int first_column, int last_column, int samples_a_side)
      : first(first_row),
        last(last_row),
        left(first_column),
        right(last_column),
        per_pixel(samples_a_side) {
    const auto positions = [&](int from, int to) {
      std::vector<double> at;
      for (int g = from * per_pixel - kExtraTaps / 2; g < to * per_pixel + kExtraTaps / 2; ++g) {
        at.push_back((g + 0.5) / per_pixel - 0.5);
      }
      return at;
    };
    y = positions(first, last);
    x = positions(left, right);
    clear.assign(x.size() * y.size(), 1.0F);
  }
  float* row(std::size_t index) { return clear.data() + index * x.size(); }
  const float* row(std::size_t index) const { return clear.data() + index * x.size(); }
  // Indices [begin, end) of the samples whose column lies in [from, to], px.
  std::pair<int, int> samples(double from, double to) const {
    const auto index = [&](double at) {
      return std::clamp((at - x.front()) * per_pixel, -1.0, static_cast<double>(x.size()));
    };
    return {
        static_cast<int>(std::ceil(std::max(0.0, index(from)))),
        static_cast<int>(std::floor(std::min(index(to), static_cast<double>(x.size()) - 1) + 1))};
  }
};

}  // namespace impactdic::sim::speckle
