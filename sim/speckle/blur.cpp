#include "sim/speckle/blur.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>

namespace impactdic::sim::speckle {
namespace {

constexpr double kStepsPerSigma = 6;  // cubic Hermite cells: error 1e-6 of a full edge

// e^{−x} I₁(x), x >= 0. Abramowitz & Stegun (1964), 9.8.3 and 9.8.4: relative error below 3e-7.
double scaled_bessel_i1(double x) {
  if (x < 3.75) {
    const double t = (x / 3.75) * (x / 3.75);
    const double series =
        0.5 + t * (0.87890594 +
                   t * (0.51498869 +
                        t * (0.15084934 + t * (0.02658733 + t * (0.00301532 + t * 0.00032411)))));
    return x * series * std::exp(-x);
  }
  const double t = 3.75 / x;
  const double high = 0.02282967 + t * (-0.02895312 + t * (0.01787654 - t * 0.00420059));
  const double series =
      0.39894228 +
      t * (-0.03988024 + t * (-0.00362018 + t * (0.00163801 + t * (-0.01031555 + t * high))));
  return series / std::sqrt(x);
}

}  // namespace

BlurredDisc::BlurredDisc(double radius_px, double sigma_px, double least_px, double most) {
  const double r = radius_px, variance = sigma_px * sigma_px;
  core_px_ = std::max(0.0, r - kEdgeReach * sigma_px);
  reach_px_ = r + kEdgeReach * sigma_px;
  const int count = static_cast<int>(std::ceil((reach_px_ - core_px_) / sigma_px * kStepsPerSigma));
  const double step = (reach_px_ - core_px_) / count;
  per_step_ = 1 / step;
  const auto slope = [&](double d) {
    return -r / variance * std::exp(-(d - r) * (d - r) / (2 * variance)) *
           scaled_bessel_i1(r * d / variance);
  };
  static const Quadrature rule = gauss_legendre(4);
  cells_.resize(static_cast<std::size_t>(count) + 1);
  cells_.back() = {0, 0, 0, 0};  // reached only by rounding at reach_px_
  double right = 0, right_slope = slope(reach_px_) * step;
  const int innermost = static_cast<int>(std::max(0.0, (least_px - core_px_) * per_step_));
  for (int i = count - 1; i >= innermost; --i) {
    const double start = core_px_ + i * step;
    double drop = 0;
    for (int k = 0; k < 4; ++k) {
      drop -= rule.weight[k] * slope(start + (rule.node[k] + 0.5) * step) * step;
    }
    const double left = right + drop, left_slope = slope(start) * step, rise = right - left;
    cells_[static_cast<std::size_t>(i)] = {
        static_cast<float>(left), static_cast<float>(left_slope),
        static_cast<float>(3 * rise - 2 * left_slope - right_slope),
        static_cast<float>(left_slope + right_slope - 2 * rise)};
    right = left;
    right_slope = left_slope;
    if (left > most) {
      std::fill(cells_.begin(), cells_.begin() + i, Cell{1, 0, 0, 0});
      break;
    }
  }
}

void BlurredDisc::cover(const double* squared, int count, float* clear) const {
  constexpr int kBlock = 64;
  int index[kBlock];
  float within[kBlock];
  const Cell* cells = cells_.data();
  const double last = static_cast<double>(cells_.size() - 1);  // its cell is 0 throughout
  for (int first = 0; first < count; first += kBlock) {
    const int n = std::min(kBlock, count - first);
    for (int i = 0; i < n; ++i) {
      const double distance = std::sqrt(std::max(0.0, squared[first + i]));
      const double inside = std::min(std::max(0.0, (distance - core_px_) * per_step_), last);
      const double u = distance >= reach_px_ ? last : inside;
      index[i] = static_cast<int>(u);
      within[i] = static_cast<float>(u - index[i]);
    }
    float* __restrict at = clear + first;  // no cell is written
    for (int i = 0; i < n; ++i) {
      const Cell& c = cells[index[i]];
      const float t = within[i];
      at[i] *= 1.0F - (((c.c3 * t + c.c2) * t + c.c1) * t + c.c0);
    }
  }
}

double blurred_edge(double into_px, double sigma_px) {
  return 0.5 * std::erfc(-into_px / (sigma_px * std::sqrt(2.0)));
}

Quadrature gauss_legendre(int count) {
  Quadrature rule;
  for (int i = 0; i < count; ++i) {
    double x = -std::cos(kPi * (i + 0.75) / (count + 0.5));  // Tricomi's estimate
    double derivative = 1;
    for (int newton = 0; newton < 50; ++newton) {
      double before = 1, value = x;
      for (int n = 2; n <= count; ++n) {
        const double next = ((2 * n - 1) * x * value - (n - 1) * before) / n;
        before = value;
        value = next;
      }
      derivative = count * (x * value - before) / (x * x - 1);
      const double change = value / derivative;
      x -= change;
      if (std::abs(change) < 1e-15) break;
    }
    rule.node.push_back(x / 2);
    rule.weight.push_back(1 / ((1 - x * x) * derivative * derivative));
  }
  return rule;
}

Quadrature shared_samples(int per_pixel, int taps) {
  // Weights w_k = ∫ ℓ_k: integrate the Lagrange polynomials exactly by Gauss–Legendre.
  const Quadrature exact = gauss_legendre(taps / 2 + 1);
  Quadrature rule;
  for (int k = 0; k < taps; ++k) {
    rule.node.push_back((k - (taps - 1) / 2.0) / per_pixel);
  }
  for (const double here : rule.node) {
    double weight = 0;
    for (std::size_t i = 0; i < exact.node.size(); ++i) {
      double lagrange = 1;
      for (const double other : rule.node) {
        if (other != here) lagrange *= (exact.node[i] - other) / (here - other);
      }
      weight += exact.weight[i] * lagrange;
    }
    rule.weight.push_back(weight);
  }
  return rule;
}

}  // namespace impactdic::sim::speckle
