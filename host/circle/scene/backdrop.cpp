#include "host/circle/scene/backdrop.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "host/circle/scene/outline_places.h"
#include "host/circle/settings/backdrop.h"

namespace impactdic::circle {

double Backdrop::Outline::distance_to(double x, double y) const {
  const double u = x - circle.cx_px, v = y - circle.cy_px, r_sq = u * u + v * v;
  const double oval = e1_px * (u * u - v * v) + e2_px * 2 * u * v;
  return std::sqrt(r_sq) - circle.r_px - (oval == 0 ? 0 : oval / r_sq);
}

double Backdrop::guessed_share(const Outline& ball) const {
  int seen = 0, guessed = 0;
  for (int k = 0; k < kRimPoints; ++k) {
    const cv::Point at = rim_point(ball, 2 * std::numbers::pi * k / kRimPoints, 0.5);
    if (!cv::Rect(0, 0, guessed_.width(), guessed_.height()).contains(at)) continue;
    ++seen;
    guessed += guessed_(at.x, at.y);
  }
  return seen > 0 ? static_cast<double>(guessed) / seen : 0;
}

double Backdrop::texture_about(const Outline& ball) const {
  const cv::Rect all(0, 0, texture_.width(), texture_.height());
  double sum = 0;
  int seen = 0;
  for (int k = 0; k < kRimPoints; ++k) {
    for (double off = -kBackdrop.inside_px; off <= kBackdrop.inside_px; ++off) {
      const cv::Point at = rim_point(ball, 2 * std::numbers::pi * k / kRimPoints, off);
      if (!all.contains(at)) continue;
      sum += static_cast<double>(texture_(at.x, at.y));
      ++seen;
    }
  }
  return seen > 0 ? sum / seen : 0;
}

void Backdrop::even(const Frame& frame, const Outline& ball, Frame& out) const {
  even(frame, ball, static_cast<float>(texture_about(ball)), out);
}

void Backdrop::even(const Frame& frame, const Outline& ball, float usual, Frame& out) const {
  out = frame;
  const double to_px = -kBackdrop.inside_px, from_px = 2 * to_px;
  const auto whole = static_cast<float>(frame.full_scale());
  const auto even_rows = [&](auto& picture) {
    using Pixel = std::remove_reference_t<decltype(*picture.data())>;
    for (int y = 0; y < picture.height(); ++y) {
      Pixel* row = picture.row(y);
      const float* texture = texture_.row(y);
      for (int x = 0; x < picture.width(); ++x) {
        const double off = ball.distance_to(x, y);
        if (off < from_px) continue;
        const auto share = static_cast<float>(std::min(1.0, (off - from_px) / (to_px - from_px)));
        const float level = static_cast<float>(row[x]) - share * (texture[x] - usual);
        row[x] = static_cast<Pixel>(std::lround(std::clamp(level, 0.0f, whole)));
      }
    }
  };
  if (frame.type == PixelType::kU8) {
    even_rows(out.u8);
  } else {
    even_rows(out.u16);
  }
}

void Backdrop::even(const Frame& frame, Frame& out) const { even(frame, {}, 0, out); }

}  // namespace impactdic::circle
