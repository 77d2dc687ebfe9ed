#include "host/advice/frames/frame_checks.h"

#include <impactdic/units.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "host/advice/frames/frame_floats.h"
#include "host/base/statistics.h"

namespace impactdic::advice {
namespace {

cv::Rect as_rect(const Roi& region) { return {region.x, region.y, region.width, region.height}; }

// Grey levels along a ray, `per_px` of them a pixel, from `reach_px` inside the rim to as far
// outside; empty where the ray leaves the picture.
std::vector<double> profile(const cv::Mat& picture, const Circle& ball, double angle_rad,
                            double reach_px, int per_px) {
  std::vector<double> values;
  const int count = static_cast<int>(2 * reach_px * per_px) + 1;
  for (int i = 0; i < count; ++i) {
    const double r = ball.r_px - reach_px + static_cast<double>(i) / per_px;
    const double x = ball.cx_px + r * std::cos(angle_rad), y = ball.cy_px + r * std::sin(angle_rad);
    const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
    if (x0 < 0 || y0 < 0 || x0 + 1 >= picture.cols || y0 + 1 >= picture.rows) return {};
    const double u = x - x0, v = y - y0;
    const float *a = picture.ptr<float>(y0) + x0, *b = picture.ptr<float>(y0 + 1) + x0;
    values.push_back((1 - v) * ((1 - u) * a[0] + u * a[1]) + v * ((1 - u) * b[0] + u * b[1]));
  }
  return values;
}

// From 10 to 90 % of the step between the profile's ends; nullopt where the ends are not level.
std::optional<double> step_width_px(const std::vector<double>& values, int per_px,
                                    double least_step) {
  constexpr double kLevel = 0.15;  // of the step: what the ends may vary by
  const std::size_t end = values.size() / 5;
  const auto [in_low, in_high] = std::minmax_element(values.begin(), values.begin() + end);
  const auto [out_low, out_high] = std::minmax_element(values.end() - end, values.end());
  const double inside = (*in_low + *in_high) / 2, outside = (*out_low + *out_high) / 2;
  const double step = std::abs(inside - outside);
  if (step < least_step || *in_high - *in_low > kLevel * step ||
      *out_high - *out_low > kLevel * step) {
    return std::nullopt;
  }
  const auto share = [&](std::size_t i) { return (values[i] - outside) / (inside - outside); };
  std::size_t last_in = 0, first_out = values.size() - 1;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (share(i) > 0.9) last_in = i;
  }
  for (std::size_t i = values.size(); i-- > 0;) {
    if (share(i) < 0.1) first_out = i;
  }
  if (first_out <= last_in) return std::nullopt;
  return static_cast<double>(first_out - last_in) / per_px;
}

// How far odd rows lie off even ones by what they show, px; (0, 0) within chance. Least squares:
// what a row lies off the mean of those beside, by the picture's slopes there.
cv::Point2d field_shift(const cv::Mat& rows) {
  constexpr double kLeast_px = 0.1, kSds = 6;
  double xx = 0, xy = 0, yy = 0, x_off = 0, y_off = 0, off_sq = 0;
  int count = 0;
  for (int y = 1; y + 1 < rows.rows; ++y) {
    const float *above = rows.ptr<float>(y - 1), *row = rows.ptr<float>(y),
                *below = rows.ptr<float>(y + 1);
    const double sign = y % 2 == 0 ? 1 : -1;
    for (int x = 1; x + 1 < rows.cols; ++x) {
      // Slopes of the rows beside alone: the row's own noise is in what it lies off by.
      const double sx = 0.25 * (above[x + 1] - above[x - 1] + below[x + 1] - below[x - 1]);
      const double sy = 0.5 * (below[x] - above[x]);
      const double off = sign * (row[x] - 0.5 * (above[x] + below[x]));
      xx += sx * sx, xy += sx * sy, yy += sy * sy;
      x_off += sx * off, y_off += sy * off, off_sq += off * off;
      ++count;
    }
  }
  const double determinant = xx * yy - xy * xy;
  if (!(determinant > 0)) return {};
  const cv::Point2d shift((yy * x_off - xy * y_off) / determinant,
                          (xx * y_off - xy * x_off) / determinant);
  const double sd = std::sqrt(off_sq / count * (xx + yy) / determinant);
  return cv::norm(shift) > std::max(kLeast_px, kSds * sd) ? shift : cv::Point2d();
}

// Whether odd rows show another time, or place, than even ones: most bands of rows say so, by the
// same shift. A sharp edge that lies along the rows says so of its own band alone.
bool is_woven(const cv::Mat& picture) {
  constexpr int kBands = 6, kFewestRows = 8;
  constexpr double kAlike = 0.5;
  const int height = picture.rows / kBands / 2 * 2;
  if (height < kFewestRows || picture.cols < kFewestRows) return false;
  std::vector<cv::Point2d> shifts;
  cv::Point2d mean;
  for (int k = 0; k < kBands; ++k) {
    const cv::Point2d shift = field_shift(picture.rowRange(k * height, (k + 1) * height));
    if (shift == cv::Point2d()) continue;
    shifts.push_back(shift);
    mean += shift;
  }
  mean /= std::max<double>(1, static_cast<double>(shifts.size()));
  const auto alike = std::count_if(shifts.begin(), shifts.end(), [&](const cv::Point2d& shift) {
    return cv::norm(shift - mean) < kAlike * cv::norm(mean);
  });
  return 3 * alike >= 2 * kBands;
}

// Whether neighbouring rows differ more than every other row does, which columns do not: fields
// that lie far apart, in which nothing is alike.
bool rows_differ_more(const cv::Mat& picture) {
  constexpr int kSmallest = 8;
  constexpr double kMore = 1.2;
  if (picture.cols < kSmallest || picture.rows < kSmallest) return false;
  const auto difference = [&](int dx, int dy) {
    const cv::Mat a = picture(cv::Rect(0, 0, picture.cols - dx, picture.rows - dy));
    const cv::Mat b = picture(cv::Rect(dx, dy, picture.cols - dx, picture.rows - dy));
    return cv::norm(a, b, cv::NORM_L2SQR) / static_cast<double>(a.total());
  };
  const double rows = difference(0, 1), field_rows = difference(0, 2);
  const double columns = difference(1, 0), next_columns = difference(2, 0);
  return rows > kMore * field_rows && rows * next_columns > kMore * columns * field_rows;
}

constexpr double kInner = 0.25, kOuter = 0.92;  // rings that are compared, of the radius

bool rings_are_in_view(const Frame& frame, const Circle& ball) {
  const double reach = kOuter * ball.r_px + 1;
  return ball.cx_px >= reach && ball.cy_px >= reach && ball.cx_px <= frame.width() - 1 - reach &&
         ball.cy_px <= frame.height() - 1 - reach;
}

// Rings about the centre as rows, each free of its mean. They must be in view.
cv::Mat unwrapped(const Frame& frame, const Circle& ball) {
  constexpr int kAngles = 720, kRings = 48;
  cv::Mat polar, rings;
  cv::warpPolar(as_floats(frame), polar, cv::Size(kRings, kAngles),
                cv::Point2f(static_cast<float>(ball.cx_px), static_cast<float>(ball.cy_px)),
                kOuter * ball.r_px,
                static_cast<int>(cv::INTER_LINEAR) | static_cast<int>(cv::WARP_POLAR_LINEAR));
  const int first = static_cast<int>(kRings * kInner / kOuter);
  rings = polar.colRange(first, kRings).t();
  for (int i = 0; i < rings.rows; ++i) rings.row(i) -= cv::mean(rings.row(i))[0];
  return rings;
}

}  // namespace

double saturated_share(const Frame& frame, const Roi& region, const std::optional<Circle>& ball) {
  const cv::Mat picture = as_floats(frame);
  std::int64_t full = 0, all = 0;
  for (int y = region.y; y < region.y + region.height; ++y) {
    const float* row = picture.ptr<float>(y);
    for (int x = region.x; x < region.x + region.width; ++x) {
      if (ball && std::hypot(x - ball->cx_px, y - ball->cy_px) > ball->r_px) continue;
      ++all;
      full += row[x] >= frame.full_scale();
    }
  }
  return all > 0 ? static_cast<double>(full) / static_cast<double>(all) : 0;
}

double contrast_of(const Frame& frame) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(as_floats(frame), mean, deviation);
  return deviation[0] * 255 / frame.full_scale();
}

std::optional<double> edge_width_px(const Frame& frame, const Circle& ball) {
  constexpr int kRays = 120, kPerPx = 8, kAxes = 4;
  constexpr std::size_t kFewest = 8;   // of an axis
  constexpr double kLeastStep = 0.08;  // of white
  const double reach_px = std::min(16.0, 0.3 * ball.r_px);
  const cv::Mat picture = as_floats(frame);
  std::array<std::vector<double>, kAxes> widths;
  for (int i = 0; i < kRays; ++i) {
    const auto values = profile(picture, ball, 2 * kPi * i / kRays, reach_px, kPerPx);
    if (values.empty()) continue;
    if (const auto width = step_width_px(values, kPerPx, kLeastStep * frame.full_scale())) {
      widths[static_cast<std::size_t>(2 * kAxes * i / kRays % kAxes)].push_back(*width);
    }
  }
  // Ink at the rim makes an edge wider, and never sharper; motion blurs it along one axis.
  std::optional<double> widest;
  for (std::vector<double>& of_axis : widths) {
    if (of_axis.size() < kFewest) continue;
    const auto quarter = of_axis.begin() + static_cast<std::ptrdiff_t>(of_axis.size() / 4);
    std::nth_element(of_axis.begin(), quarter, of_axis.end());
    widest = std::max(widest.value_or(0), *quarter);
  }
  return widest;
}

bool is_interlaced(const Frame& frame, const Roi& region) {
  const cv::Mat part = as_floats(frame)(as_rect(region));
  return rows_differ_more(part) || (is_woven(part) && !is_woven(part.t()));
}

bool repeats_pixels(const Frame& frame, const Roi& region) {
  const cv::Mat part = as_floats(frame)(as_rect(region));
  return is_woven(part) && is_woven(part.t());
}

std::optional<double> turn_between_deg(const Frame& first, const Circle& first_ball,
                                       const Frame& second, const Circle& second_ball) {
  constexpr double kLeastCorrelation = 0.3;
  if (!rings_are_in_view(first, first_ball) || !rings_are_in_view(second, second_ball)) {
    return std::nullopt;
  }
  const cv::Mat a = unwrapped(first, first_ball), b = unwrapped(second, second_ball);
  const double energies = cv::norm(a) * cv::norm(b);
  if (energies <= 0) return std::nullopt;
  cv::Mat spectrum_a, spectrum_b, product, sum, correlation;
  cv::dft(a, spectrum_a, cv::DFT_ROWS);
  cv::dft(b, spectrum_b, cv::DFT_ROWS);
  cv::mulSpectrums(spectrum_b, spectrum_a, product, cv::DFT_ROWS, true);
  cv::reduce(product, sum, 0, cv::REDUCE_SUM);
  cv::idft(sum, correlation, cv::DFT_SCALE | cv::DFT_ROWS);
  double highest = 0;
  cv::Point at;
  cv::minMaxLoc(correlation, nullptr, &highest, nullptr, &at);
  if (highest < kLeastCorrelation * energies) return std::nullopt;
  const double turn = 360.0 * at.x / a.cols;
  return std::min(turn, 360 - turn);
}

std::optional<double> shift_between_px(const Frame& first, const Frame& second, const Roi& region) {
  constexpr double kLeastResponse = 0.15;
  const cv::Mat a = as_floats(first)(as_rect(region)), b = as_floats(second)(as_rect(region));
  if (a.rows < 16 || a.cols < 16) return std::nullopt;
  cv::Mat window;
  cv::createHanningWindow(window, a.size(), CV_32F);
  double response = 0;
  const cv::Point2d shift = cv::phaseCorrelate(a, b, window, &response);
  if (response < kLeastResponse) return std::nullopt;
  return std::hypot(shift.x, shift.y);
}

}  // namespace impactdic::advice
