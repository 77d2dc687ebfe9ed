#include "host/motion/ball_crop.h"

#include <algorithm>
#include <cmath>

namespace impactdic::motion {
namespace {

// A ball under compression is wider than the free one.
constexpr double kWidest = 1.1;
// Windows are measured where they lie on the ball, and sought no farther than their search from it;
// beyond, B-splines forget the border of their picture within this to 1e-6.
constexpr int kBeyond_px = 24;
// Rows of whole vectors and cache lines.
constexpr int kStep_px = 16;

int side_px(const EstimatorOptions& options, double radius_px) {
  const int reach = std::max({options.field.window_px, options.field.search_px, kBeyond_px});
  const int side = 2 * (static_cast<int>(std::ceil(kWidest * radius_px)) + reach);
  return (side + kStep_px - 1) / kStep_px * kStep_px;
}

// NaN, of a frame without a ball, is its border.
int begin(double centre, int part, int whole) {
  const double at = centre - 0.5 * part;
  return static_cast<int>(at > 0 ? std::min<double>(at, whole - part) : 0);
}

void move_circle(Circle& circle, const CropOrigin& by, int sign) {
  circle.cx_px += sign * by.x;
  circle.cy_px += sign * by.y;
}

}  // namespace

BallCrop::BallCrop(const EstimatorOptions& options, double radius_px, int width, int height)
    : frame_width_(width),
      frame_height_(height),
      width_(std::min(width, side_px(options, radius_px))),
      height_(std::min(height, side_px(options, radius_px))) {}

CropOrigin BallCrop::about(const Circle& ball) const {
  return {begin(ball.cx_px, width_, frame_width_), begin(ball.cy_px, height_, frame_height_)};
}

void into_crops(PairMotion& pair, const CropOrigin& first, const CropOrigin& second) {
  move_circle(pair.first, first, -1);
  move_circle(pair.second, second, -1);
  pair.first_left_px = first.x;
  pair.first_top_px = first.y;
  pair.second_left_px = second.x;
  pair.second_top_px = second.y;
}

void out_of_crops(PairMotion& pair, const CropOrigin& first, const CropOrigin& second) {
  move_circle(pair.first, first, 1);
  move_circle(pair.second, second, 1);
  pair.first_left_px = pair.first_top_px = pair.second_left_px = pair.second_top_px = 0;
  const int u = second.x - first.x, v = second.y - first.y;
  pair.motion.dx_px += u;
  pair.motion.dy_px += v;
  pair.centre.u_px += u;
  pair.centre.v_px += v;
  for (Window& window : pair.windows) {
    window.x0 += first.x;
    window.y0 += first.y;
    window.guess_u += u;
    window.guess_v += v;
  }
  for (WindowMotion& motion : pair.field) {
    motion.u += static_cast<float>(u);
    motion.v += static_cast<float>(v);
  }
}

}  // namespace impactdic::motion
