#include "host/advice/reflex.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "host/base/statistics.h"

namespace impactdic::advice {
namespace {

constexpr double kBlurOfRadius = 0.08, kLeastBlurPx = 1.5;  // what is smoother is shading
constexpr double kNoises = 6, kOfStrongest = 0.05;          // what stands out
constexpr double kSpotOfRadius = 0.35;  // a lamp's reflex on a ball is not larger
constexpr double kInSpot = 0.97;        // of what stands out

// The square about the ball, in grey levels of 255 above its own blurred picture; empty where the
// ball does not lie in the picture.
cv::Mat without_shading(const Frame& frame, const Circle& ball, double blur_px, cv::Point& corner) {
  const cv::Rect square(static_cast<int>(ball.cx_px - ball.r_px),
                        static_cast<int>(ball.cy_px - ball.r_px), static_cast<int>(2 * ball.r_px),
                        static_cast<int>(2 * ball.r_px));
  const cv::Rect inside = square & cv::Rect(0, 0, frame.width(), frame.height());
  if (inside != square) return {};
  corner = inside.tl();
  const cv::Mat stored(frame.height(), frame.width(),
                       frame.type == PixelType::kU8 ? CV_8UC1 : CV_16UC1,
                       const_cast<void*>(frame.bytes()));
  cv::Mat levels, smooth;
  stored(inside).convertTo(levels, CV_32F, 255.0 / frame.full_scale());
  cv::GaussianBlur(levels, smooth, {}, blur_px);
  return levels - smooth;
}

}  // namespace

std::optional<Spot> only_spot(const Frame& frame, const Circle& ball, double noise) {
  const double blur_px = std::max(kLeastBlurPx, kBlurOfRadius * ball.r_px);
  const double reach_px = ball.r_px - 2 * blur_px - 2;  // the rim is no texture
  cv::Point corner;
  const cv::Mat levels = without_shading(frame, ball, blur_px, corner);
  if (levels.empty() || reach_px < 0.5 * ball.r_px) return std::nullopt;
  struct Pixel {
    double x, y, height;
  };
  std::vector<Pixel> disc;
  double strongest = 0;
  for (int v = 0; v < levels.rows; ++v) {
    for (int u = 0; u < levels.cols; ++u) {
      const double x = corner.x + u - ball.cx_px, y = corner.y + v - ball.cy_px;
      if (std::hypot(x, y) > reach_px) continue;
      disc.push_back({x, y, std::abs(levels.at<float>(v, u))});
      strongest = std::max(strongest, disc.back().height);
    }
  }
  const double stands_out = std::max(kNoises * noise, kOfStrongest * strongest);
  std::erase_if(disc, [&](const Pixel& pixel) { return pixel.height <= stands_out; });
  constexpr std::size_t kLeastPixels = 4;
  if (disc.size() < kLeastPixels) return std::nullopt;
  std::vector<double> xs, ys;
  for (const Pixel& pixel : disc) xs.push_back(pixel.x), ys.push_back(pixel.y);
  const double x = upper_median(std::move(xs)), y = upper_median(std::move(ys));
  const auto near = std::count_if(disc.begin(), disc.end(), [&](const Pixel& pixel) {
    return std::hypot(pixel.x - x, pixel.y - y) < kSpotOfRadius * ball.r_px;
  });
  if (static_cast<double>(near) < kInSpot * static_cast<double>(disc.size())) return std::nullopt;
  return Spot{x / ball.r_px, y / ball.r_px};
}

bool is_reflex_alone(std::span<const BallView> views, double noise) {
  constexpr std::size_t kLeastFrames = 4;
  constexpr double kStays = 0.05;  // radii
  if (views.size() < kLeastFrames) return false;
  std::optional<Spot> first;
  return std::all_of(views.begin(), views.end(), [&](const BallView& view) {
    const std::optional<Spot> spot = only_spot(*view.frame, view.ball, noise);
    if (!first) first = spot;
    return spot && std::hypot(spot->x - first->x, spot->y - first->y) < kStays;
  });
}

const char* const kReflexAlone =
    "the ball's only texture is a spot that stays where it is, as a lamp's reflex does: no spin is "
    "stated, and the speed is that of the circle; paint speckles on the ball";

}  // namespace impactdic::advice
