#include "host/advice/frames/noise_memory.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "host/advice/frames/frame_floats.h"
#include "host/base/statistics.h"

namespace impactdic::advice {
namespace {

// What a pixel differs by from the next one in its row: light that flickers falls out.
cv::Mat beside(const cv::Mat& picture) {
  return picture.colRange(1, picture.cols) - picture.colRange(0, picture.cols - 1);
}

// How steep the picture is without its noise, grey levels a pixel.
cv::Mat slope_of(const cv::Mat& picture) {
  constexpr double kSmoothPx = 1.5;
  cv::Mat smooth, right, down, slope;
  cv::GaussianBlur(picture, smooth, {}, kSmoothPx);
  cv::Sobel(smooth, right, CV_32F, 1, 0, 3, 0.125);
  cv::Sobel(smooth, down, CV_32F, 0, 1, 3, 0.125);
  cv::magnitude(right, down, slope);
  return slope;
}

double scatter_of(const cv::Mat& values) {
  constexpr double kPerMedian = 1.48;  // of a normal deviate's size
  std::vector<float> sizes;
  for (int y = 0; y < values.rows; y += 2) {
    for (int x = 0; x < values.cols; x += 2) sizes.push_back(std::abs(values.at<float>(y, x)));
  }
  return sizes.empty() ? 0 : kPerMedian * static_cast<double>(upper_median(std::move(sizes)));
}

bool is_beside_a_ball(int x, int y, const std::vector<Circle>& balls) {
  constexpr double kReach = 1.25;  // radii
  return std::ranges::any_of(balls, [&](const Circle& ball) {
    return std::hypot(x - ball.cx_px, y - ball.cy_px) < kReach * ball.r_px;
  });
}

}  // namespace

std::optional<NoiseMemory> noise_memory(const Frame& first, const Frame& second, const Frame& third,
                                        const std::vector<Circle>& balls) {
  constexpr int kFewest = 2000;
  constexpr double kStray = 5;     // deviations: something moves there
  constexpr double kSteep = 0.15;  // of a deviation a pixel: what trembles would tell there
  const cv::Mat a = as_floats(first), b = as_floats(second), c = as_floats(third);
  if (a.size() != b.size() || b.size() != c.size() || a.cols < 2) return std::nullopt;
  const cv::Mat before = beside(b - a), after = beside(c - b), slope = slope_of((a + b + c) / 3);
  const double scatter = scatter_of(before);
  if (!(scatter > 0)) return std::nullopt;
  double product = 0, before_sq = 0, after_sq = 0;
  int count = 0;
  for (int y = 0; y < before.rows; ++y) {
    const float *u = before.ptr<float>(y), *v = after.ptr<float>(y), *t = slope.ptr<float>(y);
    for (int x = 0; x < before.cols; x += 2) {
      const double largest = std::max(std::abs(u[x]), std::abs(v[x]));
      if (largest > kStray * scatter || t[x] > kSteep * scatter) continue;
      if (is_beside_a_ball(x, y, balls)) continue;
      product += u[x] * v[x];
      before_sq += u[x] * u[x];
      after_sq += v[x] * v[x];
      ++count;
    }
  }
  if (count < kFewest || !(before_sq > 0 && after_sq > 0)) return std::nullopt;
  const double correlation = product / std::sqrt(before_sq * after_sq);
  const double sd = (1 - correlation * correlation) / std::sqrt(static_cast<double>(count));
  return NoiseMemory{1 + 2 * correlation, 2 * sd};
}

}  // namespace impactdic::advice
