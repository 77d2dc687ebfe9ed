// Pixels beside an outline. Internal to host/circle.
#pragma once

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "host/circle/scene/backdrop.h"

namespace impactdic::circle {

inline constexpr int kRimPoints = 180;  // of a rim that are looked at

// The part of a picture that lies so near a ball, on all sides.
inline cv::Rect box_about(const Backdrop::Outline& outline, double beyond_px, cv::Size size) {
  const Circle& ball = outline.circle;
  const double reach = ball.r_px + std::hypot(outline.e1_px, outline.e2_px) + beyond_px;
  const int left = std::clamp(static_cast<int>(ball.cx_px - reach), 0, size.width);
  const int top = std::clamp(static_cast<int>(ball.cy_px - reach), 0, size.height);
  const int right = std::clamp(static_cast<int>(ball.cx_px + reach) + 2, left, size.width);
  const int bottom = std::clamp(static_cast<int>(ball.cy_px + reach) + 2, top, size.height);
  return {left, top, right - left, bottom - top};
}

// The pixel so far outside the rim in a direction.
inline cv::Point rim_point(const Backdrop::Outline& ball, double angle, double outside_px) {
  const double oval = ball.e1_px * std::cos(2 * angle) + ball.e2_px * std::sin(2 * angle);
  const double r = ball.circle.r_px + oval + outside_px;
  return {static_cast<int>(std::lround(ball.circle.cx_px + r * std::cos(angle))),
          static_cast<int>(std::lround(ball.circle.cy_px + r * std::sin(angle)))};
}

}  // namespace impactdic::circle
