// Pictures of a turning sphere for tests, made by another way than the renderer's: a smooth random
// field in space (Perlin 2002) cut by the sphere and sampled many times a pixel.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

#include "host/dic/sphere/rotation.h"
#include "impactdic/image.h"

namespace impactdic::testing {

struct SpherePose {
  double cx_px = 0, cy_px = 0;
  // From the ball's axes to the camera's: X right, Y up, Z towards the camera.
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  // Seen from near by: one over the distance, 1/px, and how far the centre is from the optical axis
  // over the distance, y down. The ball is shorter by this share along y.
  double by_distance = 0, aside_x = 0, aside_y = 0;
  double compression = 0;
};

class SpherePictures {
 public:
  SpherePictures(unsigned seed, double radius_px, double grain_px = 7)
      : radius_px_(radius_px), grain_px_(grain_px) {
    std::iota(order_.begin(), order_.begin() + 256, 0);
    std::shuffle(order_.begin(), order_.begin() + 256, std::mt19937(seed));
    std::copy(order_.begin(), order_.begin() + 256, order_.begin() + 256);
  }

  // Grey levels of 255; 4 × 4 samples a pixel under a Gaussian point spread function of 0.6 px.
  Frame render(const SpherePose& pose, int width, int height, double noise, unsigned seed) const {
    constexpr int kSide = 4;
    const int across = kSide * width, down = kSide * height;
    std::vector<float> fine(static_cast<std::size_t>(across) * static_cast<std::size_t>(down));
    const Eigen::Matrix3d back = pose.turn.conjugate().toRotationMatrix();
    for (int j = 0; j < down; ++j) {
      for (int i = 0; i < across; ++i) {
        const double x = (i + 0.5) / kSide - 0.5 - pose.cx_px;
        const double y = -((j + 0.5) / kSide - 0.5 - pose.cy_px);
        const Eigen::Vector3d at = on_ball(pose, x, y);
        float& level = fine[static_cast<std::size_t>(j) * static_cast<std::size_t>(across) +
                            static_cast<std::size_t>(i)];
        level = std::isnan(at.z()) ? 60 : static_cast<float>(paint(back * at));
      }
    }
    blur(fine, across, down, kSide);
    std::mt19937 random(seed);
    std::normal_distribution<double> deviate(0, 1);
    Frame frame;
    frame.reset(width, height, 8);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        double mean = 0;
        for (int j = 0; j < kSide; ++j) {
          for (int i = 0; i < kSide; ++i) {
            mean +=
                fine[static_cast<std::size_t>(kSide * y + j) * static_cast<std::size_t>(across) +
                     static_cast<std::size_t>(kSide * x + i)];
          }
        }
        mean = mean / (kSide * kSide) + noise * deviate(random);
        frame.u8(x, y) = static_cast<std::uint8_t>(std::clamp(std::lround(mean), 0L, 255L));
      }
    }
    return frame;
  }

 private:
  // The point of the round ball, y up, that is seen (x, y) px from its centre; NaN beside it.
  Eigen::Vector3d on_ball(const SpherePose& pose, double x, double y) const {
    const double flat = 1 - pose.compression;
    const Eigen::Vector3d from(x, y / flat, 0);
    const Eigen::Vector3d to_eye(-pose.aside_x - pose.by_distance * x,
                                 (pose.aside_y - pose.by_distance * y) / flat, 1);
    const double a = to_eye.squaredNorm(), b = from.dot(to_eye);
    const double c = from.squaredNorm() - radius_px_ * radius_px_;
    return from + (std::sqrt(b * b - a * c) - b) / a * to_eye;
  }

  // A Gaussian of 0.6 px, `side` samples a pixel.
  static void blur(std::vector<float>& fine, int across, int down, int side) {
    constexpr int kReach = 8;
    std::array<float, 2 * kReach + 1> taps;
    for (int k = -kReach; k <= kReach; ++k) {
      taps[static_cast<std::size_t>(k + kReach)] =
          static_cast<float>(std::exp(-k * k / (2 * 0.36 * side * side)));
    }
    const float sum = std::accumulate(taps.begin(), taps.end(), 0.0F);
    for (float& tap : taps) tap /= sum;
    for (const bool rows : {true, false}) {
      std::vector<float> smooth(fine.size());
      for (int j = 0; j < down; ++j) {
        for (int i = 0; i < across; ++i) {
          float mean = 0;
          for (int k = -kReach; k <= kReach; ++k) {
            const int x = std::clamp(rows ? i + k : i, 0, across - 1);
            const int y = std::clamp(rows ? j : j + k, 0, down - 1);
            mean += taps[static_cast<std::size_t>(k + kReach)] *
                    fine[static_cast<std::size_t>(y) * static_cast<std::size_t>(across) +
                         static_cast<std::size_t>(x)];
          }
          smooth[static_cast<std::size_t>(j) * static_cast<std::size_t>(across) +
                 static_cast<std::size_t>(i)] = mean;
        }
      }
      fine.swap(smooth);
    }
  }

  // Light and dark blots some grain_px_ across, with soft edges.
  double paint(const Eigen::Vector3d& at) const {
    return 140 + 75 * std::tanh(5 * field(at / grain_px_));
  }

  double field(const Eigen::Vector3d& at) const {
    std::array<int, 3> cell;
    std::array<double, 3> t, s;
    for (int k = 0; k < 3; ++k) {
      const auto n = static_cast<std::size_t>(k);
      cell[n] = static_cast<int>(std::floor(at[k]));
      t[n] = at[k] - cell[n];
      s[n] = t[n] * t[n] * t[n] * (t[n] * (t[n] * 6 - 15) + 10);
    }
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      double weight = 1, slope = 0;
      std::size_t hash = 0;
      for (int k = 0; k < 3; ++k) {
        const auto n = static_cast<std::size_t>(k);
        const int up = corner >> k & 1;
        weight *= up ? s[n] : 1 - s[n];
        hash = order_[(hash + static_cast<std::size_t>(cell[n] + up + 256 * 64)) & 255];
      }
      for (int k = 0; k < 3; ++k) {
        const auto n = static_cast<std::size_t>(k);
        const double gradient = static_cast<int>(order_[(hash + 7 * n) & 255] % 3) - 1;
        slope += gradient * (t[n] - (corner >> k & 1));
      }
      sum += weight * slope;
    }
    return sum;
  }

  double radius_px_, grain_px_;
  std::array<std::size_t, 512> order_{};
};

}  // namespace impactdic::testing
