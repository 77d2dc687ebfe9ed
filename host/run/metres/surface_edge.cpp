#include "host/run/metres/surface_edge.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "host/run/metres/contradictions.h"

namespace impactdic::run {

double turned_into(double angle_deg) { return std::remainder(angle_deg, 360.0); }

namespace {

constexpr int kFrames = 12;      // of which the still picture is the mean
constexpr double kClear = 1.15;  // of the radius: what the ball and its blur cover
constexpr double kReach = 4;     // radii along the edge, to both sides
constexpr int kSamples = 160;    // along the edge
constexpr double kHalfCone_deg = 50, kStep_deg = 0.5;
constexpr double kOffCircle = 0.12;   // radii: how far from the circle the edge may lie
constexpr double kLeastSlope = 2;     // grey levels of 255 a pixel, mean along the edge
constexpr double kLeastLength = 1.5;  // radii that are seen of it
constexpr double kStraight = 0.7;     // of the samples must show it
constexpr double kHalfProfile_px = 5;
constexpr double kLeastSd_deg = 0.03;
// An edge need not lie along the surface to the last degree.
constexpr double kEdgeChance = 4, kTolerance_deg = 1;

// Bilinear; NaN outside, or where nothing was seen.
double grey_at(const StillPicture& still, double x, double y) {
  const double fx = std::floor(x), fy = std::floor(y);
  const int x0 = static_cast<int>(fx), y0 = static_cast<int>(fy);
  if (x0 < 0 || y0 < 0 || x0 + 1 >= still.grey.width() || y0 + 1 >= still.grey.height()) {
    return kNotMeasured;
  }
  for (const int k : {0, 1, 2, 3}) {
    if (still.seen(x0 + k % 2, y0 + k / 2) == 0) return kNotMeasured;
  }
  const double a = x - fx, b = y - fy;
  return (1 - b) * ((1 - a) * still.grey(x0, y0) + a * still.grey(x0 + 1, y0)) +
         b * ((1 - a) * still.grey(x0, y0 + 1) + a * still.grey(x0 + 1, y0 + 1));
}

// A line that touches the circle, and the axes along and across it, picture axes.
struct EdgeLine {
  double x, y;    // nearest to the circle's centre
  double mx, my;  // across, away from the ball
  double tx, ty;
};

EdgeLine line_of(const Touch& touch, double towards_rad, double off_px) {
  const double mx = std::cos(towards_rad), my = -std::sin(towards_rad);
  const double far = touch.radius_px + off_px;
  return {touch.x_px + far * mx, touch.y_px + far * my, mx, my, -my, mx};
}

// Grey level behind the line less that before it, a pixel.
double slope_at(const StillPicture& still, const EdgeLine& line, double along, double across) {
  const double x = line.x + along * line.tx + across * line.mx;
  const double y = line.y + along * line.ty + across * line.my;
  return (grey_at(still, x + line.mx, y + line.my) - grey_at(still, x - line.mx, y - line.my)) / 2;
}

double place(int sample, const Touch& touch) {
  return (2.0 * sample / (kSamples - 1) - 1) * kReach * touch.radius_px;
}

struct Found {
  double slope = 0;  // mean, with its sign
  double towards_rad = 0, off_px = 0;
};

// Mean slope along the line, 0 where too little of it is seen or too few samples show it.
double mean_slope(const StillPicture& still, const Touch& touch, const EdgeLine& line, int every) {
  double sum = 0;
  int seen = 0;
  std::vector<double> slopes;
  for (int i = 0; i < kSamples; i += every) {
    const double slope = slope_at(still, line, place(i, touch), 0);
    if (std::isnan(slope)) continue;
    sum += slope, ++seen;
    slopes.push_back(slope);
  }
  const double length = 2 * kReach * seen * every / kSamples;  // radii
  if (length < kLeastLength) return 0;
  const double mean = sum / seen;
  const auto showing = std::count_if(slopes.begin(), slopes.end(),
                                     [&](double one) { return one * mean > 0.25 * mean * mean; });
  return static_cast<double>(showing) < kStraight * seen ? 0 : mean;
}

Found search(const StillPicture& still, const Touch& touch) {
  Found best;
  const double step = std::max(1.0, touch.radius_px / 100);
  constexpr int kEvery = 3;
  const int turns = static_cast<int>(kHalfCone_deg / kStep_deg);
  for (int k = -turns; k <= turns; ++k) {
    const double towards = touch.towards_rad + k * kStep_deg * kRadPerDeg;
    for (double off = -kOffCircle * touch.radius_px; off <= kOffCircle * touch.radius_px;
         off += step) {
      const double slope = mean_slope(still, touch, line_of(touch, towards, off), kEvery);
      if (std::abs(slope) > std::abs(best.slope)) best = {slope, towards, off};
    }
  }
  return best;
}

// Where the edge lies across the line at one sample: centre of gravity of the slope.
double edge_across(const StillPicture& still, const EdgeLine& line, double along, double sign) {
  constexpr double kStep_px = 0.5, kOfPeak = 0.3;
  const int steps = static_cast<int>(kHalfProfile_px / kStep_px);
  std::vector<double> slopes;
  double peak = 0;
  for (int k = -steps; k <= steps; ++k) {
    slopes.push_back(sign * slope_at(still, line, along, k * kStep_px));
    if (std::isnan(slopes.back())) return kNotMeasured;
    peak = std::max(peak, slopes.back());
  }
  double weight = 0, moment = 0;
  for (int k = -steps; k <= steps; ++k) {
    const double w = slopes[static_cast<std::size_t>(k + steps)] - kOfPeak * peak;
    if (w > 0) weight += w, moment += w * k * kStep_px;
  }
  return peak > kLeastSlope / 2 && weight > 0 ? moment / weight : kNotMeasured;
}

// Slope of `across` over `along`, twice without what lies more than three deviations off.
std::optional<Measured> straight_line(std::vector<double> along, std::vector<double> across) {
  Measured slope;
  for (int round = 0; round < 3; ++round) {
    const auto count = static_cast<double>(along.size());
    if (along.size() < kSamples / 10) return std::nullopt;
    const double a = std::accumulate(along.begin(), along.end(), 0.0) / count;
    const double b = std::accumulate(across.begin(), across.end(), 0.0) / count;
    double squares = 0, products = 0;
    for (std::size_t i = 0; i < along.size(); ++i) {
      squares += (along[i] - a) * (along[i] - a), products += (along[i] - a) * (across[i] - b);
    }
    slope.value = products / squares;
    double left = 0;
    const auto off = [&](std::size_t i) { return across[i] - b - slope.value * (along[i] - a); };
    for (std::size_t i = 0; i < along.size(); ++i) left += off(i) * off(i);
    const double scatter = std::sqrt(left / (count - 2));
    slope.sd = scatter / std::sqrt(squares);
    std::vector<double> kept_along, kept_across;
    for (std::size_t i = 0; i < along.size(); ++i) {
      if (std::abs(off(i)) > 3 * scatter) continue;
      kept_along.push_back(along[i]), kept_across.push_back(across[i]);
    }
    along = std::move(kept_along), across = std::move(kept_across);
  }
  return slope;
}

// Removes the disc of the ball, and what follows its rim.
bool covers(const TrackRow& row, int x, int y) {
  return std::hypot(x - row.cx_px, y - row.cy_px) < kClear * row.r_px + 2;
}

}  // namespace

StillPicture still_picture(FrameSource& source, const TrackRows& rows, const Touch& touch) {
  const ClipInfo& info = source.info();
  StillPicture still;
  still.grey = Image<float>(info.width, info.height, 0.0F);
  still.seen = Image<std::uint8_t>(info.width, info.height, 0);
  const double far = (kReach + 1 + kOffCircle) * touch.radius_px + kHalfProfile_px + 2;
  const auto from = [&](double at) { return std::max(0, static_cast<int>(at - far)); };
  const auto to = [&](double at, int size) { return std::min(size, static_cast<int>(at + far)); };
  Frame frame;
  for (int k = 0; k < kFrames; ++k) {
    const std::size_t at = rows.size() * static_cast<std::size_t>(k) / kFrames;
    if (at >= rows.size()) continue;
    const TrackRow row = rows[at];
    if (!row.circle_ok) continue;
    source.read(row.frame, frame);
    const Image<float> picture = frame.to_float();
    const auto unit = static_cast<float>(255 / frame.full_scale());
    for (int y = from(touch.y_px); y < to(touch.y_px, info.height); ++y) {
      for (int x = from(touch.x_px); x < to(touch.x_px, info.width); ++x) {
        if (covers(row, x, y)) continue;
        still.grey(x, y) += unit * picture(x, y);
        ++still.seen(x, y);
      }
    }
  }
  for (std::size_t i = 0; i < still.grey.size(); ++i) {
    if (still.seen.data()[i] > 0) still.grey.data()[i] /= still.seen.data()[i];
  }
  return still;
}

std::optional<Measured> edge_angle_deg(const StillPicture& still, const Touch& touch) {
  const Found found = search(still, touch);
  if (std::abs(found.slope) < kLeastSlope) return std::nullopt;
  const EdgeLine line = line_of(touch, found.towards_rad, found.off_px);
  std::vector<double> along, across;
  for (int i = 0; i < kSamples; ++i) {
    const double at = place(i, touch);
    const double off = edge_across(still, line, at, found.slope > 0 ? 1 : -1);
    if (std::isfinite(off)) along.push_back(at), across.push_back(off);
  }
  const std::optional<Measured> turn = straight_line(along, across);
  if (!turn) return std::nullopt;
  // Along the line is clockwise of across, with y down: where the edge lies farther across with the
  // way along, it turns counter-clockwise as seen.
  const double towards_deg = (found.towards_rad + std::atan(turn->value)) * kDegPerRad;
  return Measured{turned_into(towards_deg + 90), std::max(turn->sd * kDegPerRad, kLeastSd_deg)};
}

std::optional<Measured> surface_in_picture(FrameSource& source, const TrackRows& rows,
                                           const ImpactAnalysis& analysis) {
  const FlightMotion &before = analysis.before, &after = analysis.after;
  if (before.last == 0 || after.last == 0 || !std::isfinite(analysis.turn.value)) {
    return std::nullopt;
  }
  // The ball touches where the flight before ends.
  const std::size_t last = std::min(before.last, rows.size() - 1);
  const TrackRow& row = rows[last];
  if (!row.circle_ok) return std::nullopt;
  Touch touch{row.cx_px, row.cy_px, analysis.radius_px.value, 0};
  touch.towards_rad =
      std::atan2(before.vy.value - after.vy.value, before.vx.value - after.vx.value);
  if (!(touch.radius_px > 0) || !std::isfinite(touch.towards_rad)) return std::nullopt;
  try {
    return edge_angle_deg(still_picture(source, rows, touch), touch);
  } catch (const Error&) {
    return std::nullopt;  // the figures do not hang on it
  }
}

void compare_with_edge(const TrackRequest& request, const Measured& edge_deg,
                       ImpactFigures& figures) {
  const double off = turned_into(edge_deg.value - request.surface_angle_deg);
  const double allowed =
      kEdgeChance * std::hypot(edge_deg.sd, request.surface_angle_sd_deg) + kTolerance_deg;
  if (std::abs(off) <= allowed || contradicts(figures, "surface_angle")) return;
  const Measured& spin = figures.surface_angle_deg;
  if (std::isfinite(spin.value) && kEdgeChance * spin.sd < std::abs(off) / 2) return;
  char text[200];
  std::snprintf(text, sizeof text,
                "an edge that the ball touches lies at %.2f +- %.2f degrees in the picture, %g is "
                "given: is --surface-angle-deg right?",
                edge_deg.value, edge_deg.sd, request.surface_angle_deg);
  figures.contradictions.push_back({"surface_angle", text, figures_of_surface()});
}

}  // namespace impactdic::run
