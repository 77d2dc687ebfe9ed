#include "host/report/picture/overlay.h"

#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>

namespace impactdic::report {
namespace {

// OpenCV draws with this many fractional bits of a pixel.
constexpr int kShift = 4;
const cv::Scalar kCircleColour(60, 60, 230), kPathColour(230, 140, 30), kArrowColour(40, 200, 60),
    kTextColour(30, 220, 250);

cv::Point fixed(double x, double y) {
  return {static_cast<int>(std::lround(x * (1 << kShift))),
          static_cast<int>(std::lround(y * (1 << kShift)))};
}

cv::Mat to_colour(const Frame& frame) {
  cv::Mat grey(frame.height(), frame.width(), CV_8U);
  if (frame.type == PixelType::kU8) {
    std::memcpy(grey.data, frame.u8.data(), frame.u8.size());
  } else {
    const cv::Mat deep(frame.height(), frame.width(), CV_16U,
                       const_cast<std::uint16_t*>(frame.u16.data()));
    deep.convertTo(grey, CV_8U, 255.0 / frame.full_scale());
  }
  cv::Mat colour;
  cv::cvtColor(grey, colour, cv::COLOR_GRAY2BGR);
  return colour(cv::Rect(0, 0, frame.width() & ~1, frame.height() & ~1)).clone();
}

}  // namespace

OverlayPainter::OverlayPainter(double arrow_scale, int origin_x, int origin_y,
                               std::span<const TrackRow> earlier)
    : arrow_scale_(arrow_scale), origin_x_(origin_x), origin_y_(origin_y) {
  for (const TrackRow& row : earlier) {
    if (row.circle_ok) trajectory_.push_back({row.cx_px - origin_x, row.cy_px - origin_y});
  }
}

ColourPicture OverlayPainter::paint(const Frame& frame, const TrackRow& row,
                                    std::span<const Window> windows,
                                    std::span<const WindowMotion> field, int window_px) {
  cv::Mat picture = to_colour(frame);
  const double half = (window_px - 1) / 2.0;
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (field[i].status != static_cast<idic_int>(WindowStatus::kOk)) continue;
    const double x = windows[i].x0 + half - origin_x_, y = windows[i].y0 + half - origin_y_;
    cv::line(picture, fixed(x, y),
             fixed(x + arrow_scale_ * field[i].u, y + arrow_scale_ * field[i].v), kArrowColour, 1,
             cv::LINE_AA, kShift);
    cv::circle(picture, fixed(x, y), 1 << kShift, kArrowColour, -1, cv::LINE_AA, kShift);
  }
  if (row.circle_ok) {
    const double x = row.cx_px - origin_x_, y = row.cy_px - origin_y_;
    trajectory_.push_back({x, y});
    cv::circle(picture, fixed(x, y), static_cast<int>(std::lround(row.r_px * (1 << kShift))),
               kCircleColour, 1, cv::LINE_AA, kShift);
    cv::circle(picture, fixed(x, y), 3 << kShift, kCircleColour, -1, cv::LINE_AA, kShift);
  }
  for (std::size_t i = 1; i < trajectory_.size(); ++i) {
    cv::line(picture, fixed(trajectory_[i - 1].x, trajectory_[i - 1].y),
             fixed(trajectory_[i].x, trajectory_[i].y), kPathColour, 1, cv::LINE_AA, kShift);
  }
  if (row.motion_ok) {
    const double x = row.cx_px - origin_x_, y = row.cy_px - origin_y_;
    cv::arrowedLine(picture, fixed(x, y),
                    fixed(x + arrow_scale_ * row.dx_px, y + arrow_scale_ * row.dy_px), kPathColour,
                    2, cv::LINE_AA, kShift, 0.25);
  }
  cv::putText(picture, "frame " + std::to_string(row.frame) + "  " + to_string(row.status), {6, 16},
              cv::FONT_HERSHEY_SIMPLEX, 0.45, kTextColour, 1, cv::LINE_AA);
  ColourPicture out{picture.cols, picture.rows, {}};
  out.bgr.assign(picture.data, picture.data + picture.total() * 3);
  return out;
}

void write_label(ColourPicture& picture, const std::vector<std::string>& lines) {
  constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX, kLongestLine = 36, kMargin = 4;
  cv::Mat canvas(picture.height, picture.width, CV_8UC3, picture.bgr.data());
  // As if every line had the longest one's length: the size does not change from frame to frame.
  const int full = cv::getTextSize(std::string(kLongestLine, '0'), kFont, 1, 1, nullptr).width;
  const double scale = std::min(0.5, (picture.width - 2.0 * kMargin) / full);
  const int line_height = static_cast<int>(std::ceil(34 * scale));
  const int top = picture.height - line_height * static_cast<int>(lines.size()) - kMargin;
  const int width = std::min(picture.width, static_cast<int>(full * scale) + 2 * kMargin);
  cv::rectangle(canvas, {0, top}, {width, picture.height}, {20, 20, 20}, cv::FILLED);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const int baseline = top + static_cast<int>((static_cast<double>(i) + 0.75) * line_height);
    cv::putText(canvas, lines[i], {kMargin, baseline}, kFont, scale, kTextColour, 1, cv::LINE_AA);
  }
}

}  // namespace impactdic::report
