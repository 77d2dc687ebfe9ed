// Lines, arrows and text on a picture, as thick as its size asks for, legible over black and white.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace impactdic::report {

struct PicturePoint {
  double x = 0, y = 0;  // px
};

class Brush {
 public:
  // Draws into `picture` (8 bits, three channels), which it does not own.
  explicit Brush(cv::Mat picture);

  void circle(const PicturePoint& centre, double radius, const cv::Scalar& colour);
  void dot(const PicturePoint& centre, const cv::Scalar& colour);
  void path(const std::vector<PicturePoint>& points, const cv::Scalar& colour);
  // From `start` along (u, v), with a head; `weight` times as thick as other lines.
  void arrow(const PicturePoint& start, double u, double v, const cv::Scalar& colour,
             double weight = 1);
  // Without a ground of its own: a dark rim keeps it legible.
  void text(const std::string& text, const PicturePoint& baseline, const cv::Scalar& colour);
  // Height of a line of text, and the width that `characters` of them need.
  int line_height() const;
  int text_width(int characters) const;

 private:
  void lines(const std::vector<std::vector<PicturePoint>>& parts, const cv::Scalar& colour,
             double weight);

  cv::Mat picture_;
  double thickness_ = 1, font_ = 0.4;
};

// The 1, 2 or 5 times a power of ten at or below `value`, which is positive.
double round_below(double value);

}  // namespace impactdic::report
