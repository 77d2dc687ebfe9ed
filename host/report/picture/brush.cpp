#include "host/report/picture/brush.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace impactdic::report {
namespace {

constexpr int kShift = 4;  // OpenCV draws with this many fractional bits of a pixel
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr int kLongestLine = 36;                       // characters that must fit
constexpr double kUsualWidth = 800, kUsualFont = 0.5;  // of text that is read with ease
const cv::Scalar kRim(20, 20, 20);

cv::Point fixed(const PicturePoint& p) {
  return {static_cast<int>(std::lround(p.x * (1 << kShift))),
          static_cast<int>(std::lround(p.y * (1 << kShift)))};
}

int width_at_scale_one(int characters) {
  return cv::getTextSize(std::string(static_cast<std::size_t>(characters), '0'), kFont, 1, 1,
                         nullptr)
      .width;
}

}  // namespace

Brush::Brush(cv::Mat picture) : picture_(std::move(picture)) {
  const double width = picture_.cols;
  thickness_ = std::max(1.0, width / kUsualWidth);
  // As large as on a usual picture, and so small that the longest line fits.
  font_ = std::min(kUsualFont * thickness_, (width - 8) / width_at_scale_one(kLongestLine));
}

void Brush::lines(const std::vector<std::vector<PicturePoint>>& parts, const cv::Scalar& colour,
                  double weight) {
  std::vector<std::vector<cv::Point>> drawn;
  for (const auto& part : parts) {
    drawn.emplace_back();
    std::transform(part.begin(), part.end(), std::back_inserter(drawn.back()), fixed);
  }
  const int thick = std::max(1, static_cast<int>(std::lround(thickness_ * weight)));
  cv::polylines(picture_, drawn, false, kRim, thick + 2, cv::LINE_AA, kShift);
  cv::polylines(picture_, drawn, false, colour, thick, cv::LINE_AA, kShift);
}

void Brush::circle(const PicturePoint& centre, double radius, const cv::Scalar& colour) {
  const int r = static_cast<int>(std::lround(radius * (1 << kShift)));
  const int thick = static_cast<int>(std::lround(thickness_));
  cv::circle(picture_, fixed(centre), r, kRim, thick + 2, cv::LINE_AA, kShift);
  cv::circle(picture_, fixed(centre), r, colour, thick, cv::LINE_AA, kShift);
}

void Brush::dot(const PicturePoint& centre, const cv::Scalar& colour) {
  const int r = static_cast<int>(std::lround(2.5 * thickness_ * (1 << kShift)));
  cv::circle(picture_, fixed(centre), r + (1 << kShift), kRim, cv::FILLED, cv::LINE_AA, kShift);
  cv::circle(picture_, fixed(centre), r, colour, cv::FILLED, cv::LINE_AA, kShift);
}

void Brush::path(const std::vector<PicturePoint>& points, const cv::Scalar& colour) {
  if (points.size() > 1) lines({points}, colour, 1);
}

void Brush::arrow(const PicturePoint& start, double u, double v, const cv::Scalar& colour,
                  double weight) {
  const double length = std::hypot(u, v);
  if (!(length > 0.5)) return;  // nothing that a pixel could show
  const double head = std::min(0.35 * length, 6 * thickness_ * weight);
  const double ex = head * u / length, ey = head * v / length;
  const PicturePoint tip{start.x + u, start.y + v};
  lines({{start, tip},
         {{tip.x - ex + 0.5 * ey, tip.y - ey - 0.5 * ex},
          tip,
          {tip.x - ex - 0.5 * ey, tip.y - ey + 0.5 * ex}}},
        colour, weight);
}

void Brush::text(const std::string& text, const PicturePoint& baseline, const cv::Scalar& colour) {
  const cv::Point at(static_cast<int>(baseline.x), static_cast<int>(baseline.y));
  const int thick = std::max(1, static_cast<int>(std::lround(1.2 * thickness_)));
  cv::putText(picture_, text, at, kFont, font_, kRim, thick + 2, cv::LINE_AA);
  cv::putText(picture_, text, at, kFont, font_, colour, thick, cv::LINE_AA);
}

int Brush::line_height() const { return static_cast<int>(std::ceil(34 * font_)); }

int Brush::text_width(int characters) const {
  return static_cast<int>(std::ceil(width_at_scale_one(characters) * font_));
}

double round_below(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  double best = power;
  for (const double step : {2.0, 5.0}) {
    if (step * power <= value * 1.0001) best = step * power;
  }
  return best;
}

}  // namespace impactdic::report
