#include "host/report/picture/overlay.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <set>

#include "host/report/picture/brush.h"
#include "host/report/picture/png.h"

namespace impactdic::report {
namespace {

// Okabe and Ito (2008), blue first: told apart with every kind of colour vision.
const cv::Scalar kCircleColour(0, 94, 255), kPathColour(233, 180, 86), kArrowColour(66, 228, 240),
    kMotionColour(0, 159, 230), kTextColour(255, 255, 255), kGround(20, 20, 20);
constexpr double kMostArrows = 150;
constexpr int kMargin = 4;
constexpr double kPathStep = 0.5;  // px between points of the path
// Of arrows whose scale the first motion sets: of a ball that hardly moves, or moves by more than
// its radius; and before there is any.
constexpr double kLargestScale = 20, kSmallestScale = 1, kUsualScale = 5;
constexpr double kFirstArrow = 0.3;  // of the radius

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

// Every k-th of the places, so that of `count` windows about kMostArrows are left.
std::set<int> thinned(const std::set<int>& places, std::size_t count) {
  const double every = std::ceil(std::sqrt(static_cast<double>(count) / kMostArrows));
  std::set<int> kept;
  int k = 0;
  for (const int place : places) {
    if (k++ % std::max(1, static_cast<int>(every)) == 0) kept.insert(place);
  }
  return kept;
}

// Which of the windows to draw.
std::vector<std::size_t> drawn_windows(std::span<const Window> windows,
                                       std::span<const WindowMotion> field) {
  std::set<int> columns, rows;
  std::size_t found = 0;
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (field[i].status != static_cast<idic_int>(WindowStatus::kOk)) continue;
    ++found;
    columns.insert(windows[i].x0);
    rows.insert(windows[i].y0);
  }
  columns = thinned(columns, found);
  rows = thinned(rows, found);
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < field.size(); ++i) {
    const bool ok = field[i].status == static_cast<idic_int>(WindowStatus::kOk);
    if (ok && columns.count(windows[i].x0) > 0 && rows.count(windows[i].y0) > 0) kept.push_back(i);
  }
  return kept;
}

// The ellipse that was fitted, closed: see TrackRow::e1_px.
std::vector<PicturePoint> ellipse_of(const TrackRow& row, const PicturePoint& centre) {
  constexpr int kPoints = 180;
  const double oval = std::hypot(row.e1_px, row.e2_px);
  const double turn = std::atan2(row.e2_px, row.e1_px) / 2;
  std::vector<PicturePoint> points;
  for (int i = 0; i <= kPoints; ++i) {
    const double angle = 2 * kPi * i / kPoints;
    const double a = (row.r_px + oval) * std::cos(angle), b = (row.r_px - oval) * std::sin(angle);
    points.push_back({centre.x + a * std::cos(turn) - b * std::sin(turn),
                      centre.y + a * std::sin(turn) + b * std::cos(turn)});
  }
  return points;
}

std::string with_unit(double value, const char* unit) {
  char text[40];
  std::snprintf(text, sizeof text, "%g %s", value, unit);
  return text;
}

}  // namespace

OverlayPainter::OverlayPainter(double arrow_scale, int origin_x, int origin_y,
                               std::span<const TrackRow> earlier)
    : arrow_scale_(arrow_scale), origin_x_(origin_x), origin_y_(origin_y) {
  for (const TrackRow& row : earlier) note(row);
}

double OverlayPainter::arrow_scale() const { return arrow_scale_ > 0 ? arrow_scale_ : kUsualScale; }

void OverlayPainter::note(const TrackRow& row) {
  if (!row.circle_ok) return;
  if (!(arrow_scale_ > 0) && row.motion_ok) {
    const double least = kFirstArrow * row.r_px / kLargestScale;
    const double moved = std::max(std::hypot(row.dx_px, row.dy_px), least);
    arrow_scale_ = std::max(kSmallestScale, round_below(kFirstArrow * row.r_px / moved));
  }
  const Point at{row.cx_px - origin_x_, row.cy_px - origin_y_};
  // A ball that rests would make the path as long as the clip.
  if (!trajectory_.empty() &&
      std::hypot(at.x - trajectory_.back().x, at.y - trajectory_.back().y) < kPathStep) {
    return;
  }
  trajectory_.push_back(at);
}

ColourPicture OverlayPainter::paint(const Frame& frame, const TrackRow& row,
                                    std::span<const Window> windows,
                                    std::span<const WindowMotion> field, int window_px) {
  note(row);
  cv::Mat picture = to_colour(frame);
  Brush brush(picture);
  const double scale = arrow_scale();
  const double half = (window_px - 1) / 2.0;
  for (const std::size_t i : drawn_windows(windows, field)) {
    const PicturePoint at{windows[i].x0 + half - origin_x_, windows[i].y0 + half - origin_y_};
    brush.arrow(at, scale * field[i].u, scale * field[i].v, kArrowColour);
  }
  std::vector<PicturePoint> path;
  for (const Point& point : trajectory_) path.push_back({point.x, point.y});
  const PicturePoint centre{row.cx_px - origin_x_, row.cy_px - origin_y_};
  if (row.circle_ok) {
    if (std::isfinite(row.e1_px)) {
      brush.path(ellipse_of(row, centre), kCircleColour);
    } else {
      brush.circle(centre, row.r_px, kCircleColour);
    }
    path.push_back(centre);
  }
  brush.path(path, kPathColour);
  if (row.circle_ok) brush.dot(centre, kCircleColour);
  if (row.motion_ok) {
    brush.arrow(centre, scale * row.dx_px, scale * row.dy_px, kMotionColour, 2);
  }
  const char* by_hand = row.by_hand == ByHand::kNo ? "" : ", by hand";
  brush.text("frame " + std::to_string(row.frame) + "  " + to_string(row.status) + by_hand,
             {kMargin, 0.75 * brush.line_height() + kMargin}, kTextColour);
  ColourPicture out{picture.cols, picture.rows, {}};
  out.bgr.assign(picture.data, picture.data + picture.total() * 3);
  return out;
}

ColourPicture draw_candidates(const Frame& frame, std::int64_t number,
                              std::span<const BallSeen> candidates) {
  cv::Mat canvas = to_colour(frame);
  Brush brush(canvas);
  for (std::size_t i = candidates.size(); i-- > 0;) {
    const BallSeen& seen = candidates[i];
    const cv::Scalar& colour = seen.frame == number ? kCircleColour : kPathColour;
    const PicturePoint centre{seen.place.cx_px, seen.place.cy_px};
    brush.circle(centre, seen.place.r_px, colour);
    brush.text(std::to_string(i + 1), centre, colour);
  }
  ColourPicture picture;
  picture.width = canvas.cols, picture.height = canvas.rows;
  picture.bgr.assign(canvas.datastart, canvas.dataend);
  return picture;
}

void write_candidates(const std::string& path, const Frame& frame, std::int64_t number,
                      std::span<const BallSeen> candidates) {
  const ColourPicture drawn = draw_candidates(frame, number, candidates);
  write_png_bgr(path, drawn.width, drawn.height, drawn.bgr);
}

void write_label(ColourPicture& picture, const std::vector<std::string>& lines) {
  constexpr int kLongestLine = 36;
  cv::Mat canvas(picture.height, picture.width, CV_8UC3, picture.bgr.data());
  Brush brush(canvas);
  const int line_height = brush.line_height();
  const int top = picture.height - line_height * static_cast<int>(lines.size()) - kMargin;
  // As if every line had the longest one's length: the size does not change from frame to frame.
  const int width = std::min(picture.width, brush.text_width(kLongestLine) + 2 * kMargin);
  cv::rectangle(canvas, {0, top}, {width, picture.height}, kGround, cv::FILLED);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    brush.text(lines[i], {kMargin, top + (static_cast<double>(i) + 0.75) * line_height},
               kTextColour);
  }
}

void write_scale(ColourPicture& picture, const PictureScale& scale) {
  constexpr int kLongestText = 10;
  constexpr double kLongestBar = 0.16;  // of the picture's width
  cv::Mat canvas(picture.height, picture.width, CV_8UC3, picture.bgr.data());
  Brush brush(canvas);
  const double longest = kLongestBar * picture.width;
  const double mm = scale.mm_per_px > 0 ? scale.mm_per_px : 1;
  const double length = round_below(longest * mm);
  // The speed whose arrow has that length.
  const double per_px = (scale.m_s_per_px > 0 ? scale.m_s_per_px : 1) / scale.arrow_scale;
  const double speed = round_below(longest * per_px);
  const int bar_width = static_cast<int>(std::ceil(longest)), line = brush.line_height();
  const int width = bar_width + brush.text_width(kLongestText) + 3 * kMargin;
  const int left = picture.width - width;
  cv::rectangle(canvas, {left, 0}, {picture.width, 2 * line + kMargin}, kGround, cv::FILLED);
  const PicturePoint bar{left + double{kMargin}, 0.6 * line};
  brush.path({bar, {bar.x + length / mm, bar.y}}, kTextColour);
  brush.arrow({bar.x, 1.6 * line}, speed / per_px, 0, kMotionColour, 1.5);
  const double text_x = left + bar_width + 2.0 * kMargin;
  brush.text(with_unit(length, scale.mm_per_px > 0 ? "mm" : "px"), {text_x, 0.85 * line},
             kTextColour);
  brush.text(with_unit(speed, scale.m_s_per_px > 0 ? "m/s" : "px"), {text_x, 1.85 * line},
             kTextColour);
}

}  // namespace impactdic::report
