#include "host/circle/silhouette.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "host/base/statistics.h"

namespace impactdic::circle {
namespace {

// Deviations of the background, and share of its distance to the brightest or darkest hundredth of
// the picture, by which the body must differ from it. [hand]
constexpr double kBackgroundSds = 8, kLeastShare = 0.1;
// A border of which the usual deviation is more than this share of that distance is no even
// background. [hand]
constexpr double kEven = 0.1;
constexpr int kLeastSide_px = 16;
// Share of the picture's shorter side that the mean radius has at least. [hand]
constexpr double kLeastRadius = 0.1;
// An outline that lies farther from its ellipse, share of the mean radius, is another shape's: a
// ribbed tomato's does so by 0.02, one that the picture's border cuts through its middle by 0.2.
// [measured]
constexpr double kElliptic = 0.06;
// Arcs of an outline whose distances from the ellipse are their own: lobes are some 45° long.
// [hand]
constexpr double kArcs = 8;

cv::Mat as_floats(const Frame& frame) {
  const int depth = frame.type == PixelType::kU8 ? CV_8U : CV_16U;
  const cv::Mat grey(frame.height(), frame.width(), depth, const_cast<void*>(frame.bytes()));
  cv::Mat floats;
  grey.convertTo(floats, CV_32F);
  return floats;
}

// How far each pixel lies from the background, as 255 or 0; empty where that is not even.
cv::Mat differing(const cv::Mat& picture) {
  std::vector<double> border, all;
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      const double level = static_cast<double>(picture.at<float>(y, x));
      all.push_back(level);
      if (x == 0 || y == 0 || x == picture.cols - 1 || y == picture.rows - 1) {
        border.push_back(level);
      }
    }
  }
  const double ground = upper_median(border);
  for (double& level : border) level = std::abs(level - ground);
  for (double& level : all) level = std::abs(level - ground);
  const double sd = 1.4826 * upper_median(border);
  const auto far = all.begin() + static_cast<std::ptrdiff_t>(0.99 * double(all.size() - 1));
  std::nth_element(all.begin(), far, all.end());
  if (!(*far > 0) || sd > kEven * *far) return {};
  cv::Mat smooth, off, differs;
  cv::GaussianBlur(picture, smooth, {}, 1);
  cv::absdiff(smooth, cv::Scalar(ground), off);
  cv::compare(off, std::max(kBackgroundSds * sd, kLeastShare * *far), differs, cv::CMP_GT);
  return differs;
}

// The largest outline of what differs.
std::vector<cv::Point> largest_outline(const cv::Mat& differs) {
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(differs, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  const auto largest = std::max_element(
      outlines.begin(), outlines.end(),
      [](const auto& a, const auto& b) { return cv::contourArea(a) < cv::contourArea(b); });
  return largest == outlines.end() ? std::vector<cv::Point>() : *largest;
}

// The ellipse by the moments of a filled outline: a uniform ellipse has a quarter of its semi-axes'
// squares as variances.
void set_ellipse(const cv::Moments& m, Silhouette& silhouette) {
  const double xx = 4 * m.mu20 / m.m00, yy = 4 * m.mu02 / m.m00, xy = 4 * m.mu11 / m.m00;
  const double middle = (xx + yy) / 2, half = std::hypot((xx - yy) / 2, xy);
  const double longer = std::sqrt(middle + half);
  const double shorter = std::sqrt(std::max(middle - half, 0.0));
  const double direction = std::atan2(2 * xy, xx - yy);  // twice the long axis' angle
  silhouette.circle = {m.m10 / m.m00, m.m01 / m.m00, (longer + shorter) / 2};
  silhouette.e1_px = (longer - shorter) / 2 * std::cos(direction);
  silhouette.e2_px = (longer - shorter) / 2 * std::sin(direction);
}

double rms_from_ellipse(const std::vector<cv::Point>& outline, const Silhouette& silhouette) {
  const Circle& circle = silhouette.circle;
  double squares = 0;
  for (const cv::Point& point : outline) {
    const double x = point.x - circle.cx_px, y = point.y - circle.cy_px;
    const double from_long = std::atan2(y, x) - std::atan2(silhouette.e2_px, silhouette.e1_px) / 2;
    const double a = silhouette.long_px(), b = silhouette.short_px();
    const double rim = a * b / std::hypot(b * std::cos(from_long), a * std::sin(from_long));
    squares += std::pow(std::hypot(x, y) - rim, 2);
  }
  return std::sqrt(squares / static_cast<double>(outline.size()));
}

}  // namespace

double Silhouette::long_px() const { return circle.r_px + std::hypot(e1_px, e2_px); }
double Silhouette::short_px() const { return circle.r_px - std::hypot(e1_px, e2_px); }

std::optional<Silhouette> find_silhouette(const Frame& frame) {
  if (std::min(frame.width(), frame.height()) < kLeastSide_px) return std::nullopt;
  const cv::Mat differs = differing(as_floats(frame));
  if (differs.empty()) return std::nullopt;
  const std::vector<cv::Point> outline = largest_outline(differs);
  const int shorter = std::min(frame.width(), frame.height());
  if (outline.size() < 8) return std::nullopt;
  Silhouette silhouette;
  silhouette.inside.resize(frame.width(), frame.height());
  cv::Mat inside(frame.height(), frame.width(), CV_8U, silhouette.inside.data());
  inside.setTo(0);
  cv::drawContours(inside, std::vector<std::vector<cv::Point>>{outline}, 0, 255, cv::FILLED);
  set_ellipse(cv::moments(inside, true), silhouette);
  silhouette.rim_px = rms_from_ellipse(outline, silhouette);
  silhouette.centre_sd_px = silhouette.rim_px * std::sqrt(2 / kArcs);
  const double r = silhouette.circle.r_px;
  const bool is_body = r > kLeastRadius * shorter && silhouette.short_px() > r / 2 &&
                       silhouette.rim_px < kElliptic * r;
  if (!is_body) return std::nullopt;
  return silhouette;
}

CircleFit as_fit(const Silhouette& silhouette) {
  CircleFit fit;
  fit.status = CircleStatus::kOk;
  fit.circle = silhouette.circle;
  fit.cx_sd_px = fit.cy_sd_px = fit.r_sd_px = silhouette.centre_sd_px;
  fit.ellipse = true;
  fit.e1_px = silhouette.e1_px;
  fit.e2_px = silhouette.e2_px;
  fit.e1_sd_px = fit.e2_sd_px = silhouette.centre_sd_px;
  return fit;
}

}  // namespace impactdic::circle
