// The paint's level at each ray. Internal to host/circle.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <vector>

#include "host/base/statistics.h"
#include "host/circle/rim/rim_levels.h"
#include "host/circle/settings/crossings.h"
#include "host/circle/settings/levels.h"

namespace impactdic::circle {

// The paint's level (see rim_levels.h) through the upper crowd of samples 3 … 13 steps inside. It
// starts from what one sample in twenty exceeds in each sector, and settles on what lies within a
// window about it that shrinks to the noise.
class RayLight {
 public:
  static constexpr int kDepths = 6;
  // Samples of one ray, 3, 5 … 13 steps inside; (x, y) is the place of their middle, in radii from
  // the centre, and `step` a step in the same unit.
  struct Column {
    float x, y, step;
    float per_distance;  // one over that of the place from the centre
    int ray;
    std::array<float, kDepths> level;
  };
  static float depth(int k) { return static_cast<float>(3 + 2 * k); }
  static constexpr float kMiddle = 8;

  void clear() { columns_.clear(); }
  void add(const Column& column) { columns_.push_back(column); }

  // `ground` is the background's level.
  void fit(float ground, float noise, int rays, std::vector<float>& scratch) {
    find_bright(rays, scratch);
    find_envelope(ground);
    const float contrast = static_cast<float>(w_[0]) - ground;
    for (const float window : settling_windows(contrast, noise)) settle(window);
  }
  float at(float c, float s) const { return static_cast<float>(w_.dot(basis(c, s))); }

 private:
  using Vector5 = Eigen::Matrix<double, 5, 1>;
  using Matrix5 = Eigen::Matrix<double, 5, 5>;
  struct Bright {
    float x, y, level;
  };
  static Vector5 basis(double x, double y) { return {1, x, y, x * x - y * y, 2 * x * y}; }

  // What one sample in twenty exceeds, by sector.
  void find_bright(int rays, std::vector<float>& scratch) {
    sectors_ = 0;
    std::size_t first = 0;
    for (int sector = 0; sector < kLevelSectors;
         ++sector) {  // columns come in the order of the rays
      scratch.clear();
      const std::size_t begin = first;
      while (first < columns_.size() && columns_[first].ray * kLevelSectors / rays == sector) {
        const auto& level = columns_[first++].level;
        scratch.insert(scratch.end(), level.begin(), level.end());
      }
      if (scratch.size() < kCrossing.sector_samples) continue;
      const Column& middle = columns_[(begin + first) / 2];
      bright_[sectors_++] = {middle.x, middle.y, quantile(scratch, kLevels.bright)};
    }
  }

  // Upper envelope of the sectors.
  void find_envelope(float ground) {
    w_.setZero();
    for (int pass = 0; pass < kLevels.envelope_passes; ++pass) {
      Matrix5 a = Matrix5::Zero();
      for (int m = 0; m < 5; ++m) a(m, m) = no_shading(m);
      Vector5 b = Vector5::Zero();
      for (int k = 0; k < sectors_; ++k) {
        const Vector5 j = basis(bright_[k].x, bright_[k].y);
        const double off = bright_[k].level - w_.dot(j);
        const bool above = pass == 0 || off > -kLevels.below * (w_[0] - ground);
        const double weight = above ? 1 : kLevels.below_weight;
        a.noalias() += weight * j * j.transpose();
        b.noalias() += weight * bright_[k].level * j;
      }
      w_ = a.ldlt().solve(b);
    }
  }

  void settle(float window) {
    Matrix5 a = Matrix5::Zero();
    for (int m = 0; m < 5; ++m) a(m, m) = kLevels.held;
    Vector5 b = a * w_;
    for (const Column& column : columns_) {
      const Vector5 j = basis(column.x, column.y);
      const float expected = static_cast<float>(w_.dot(j));
      // The light changes along the ray as the place does.
      const float slope =
          (expected - static_cast<float>(w_[0])) * column.step * column.per_distance;
      float sum = 0;
      int n = 0;
      for (int k = 0; k < kDepths; ++k) {
        const float level = column.level[k] - slope * (kMiddle - depth(k));
        const bool near = std::abs(level - expected) <= window;
        sum += near ? level : 0;
        n += near;
      }
      for (int p = 0; p < 5; ++p) {
        for (int q = 0; q <= p; ++q) a(p, q) += n * j[p] * j[q];
        b[p] += j[p] * sum;
      }
    }
    w_ = a.ldlt().solve(b);  // reads the lower triangle
  }

  std::vector<Column> columns_;
  std::array<Bright, kLevelSectors> bright_;
  int sectors_ = 0;
  Vector5 w_ = Vector5::Zero();
};

}  // namespace impactdic::circle
