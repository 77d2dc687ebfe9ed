#include "host/run/metres/lens/oval_outline.h"

#include <impactdic/units.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "host/base/statistics.h"
#include "host/clip/track_row.h"
#include "host/run/metres/lens/flight_rows.h"

namespace impactdic::run {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr struct {
  std::size_t flight = 6;  // rows of a flight, at least
  std::size_t ovals = 8;   // rows that show an ellipse, at least …
  double share = 0.4;      // … and of the flights' rows
  double bias_px = 0.03;   // of an ellipse: ink at the rim, alike from frame to frame
  double chance = 5;       // deviations
  double outlier = 4;      // of what rows usually lie off by
  double least = 0.003;    // of a stretch that matters
  double steady = 0.5;     // of the stretch that rows may scatter by
  double least_readout = 0.05, most_readout = 1.2;  // frames: within one, give or take chance
  double nearest_widths = 3;                        // from where balls are filmed, as in lens_check
} kOval;

// An ellipse over the radius, what one px/frame makes of it at a readout of one frame a row, and
// the deviation of each component.
struct RowOval {
  double e[2], by_readout[2], sd;
  bool used = true;
};

struct OvalFit {
  Vector3d value = Vector3d::Zero();  // e1, e2 in common, frames a row
  Matrix3d covariance = Matrix3d::Zero();
  double scatter_px = 0;  // rms of what is left, over the radius
};

// `with_readout`: the third unknown is sought, too; 0 elsewhere.
std::optional<OvalFit> fit_of(std::vector<RowOval> ovals, bool with_readout) {
  OvalFit fit;
  for (int round = 0; round < 3; ++round) {
    Matrix3d normal = Matrix3d::Zero();
    if (!with_readout) normal(2, 2) = 1e30;
    Vector3d side = Vector3d::Zero();
    double count = 0;
    const auto slope = [](const RowOval& oval, int k) {
      return Vector3d(k == 0, k == 1, oval.by_readout[k]);
    };
    for (const RowOval& oval : ovals) {
      for (int k = 0; oval.used && k < 2; ++k) {
        normal += slope(oval, k) * slope(oval, k).transpose() / (oval.sd * oval.sd);
        side += slope(oval, k) * oval.e[k] / (oval.sd * oval.sd);
        ++count;
      }
    }
    const Vector3d scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::LDLT<Matrix3d> solver(scale.asDiagonal() * normal * scale.asDiagonal());
    if (count < 2 * kOval.ovals || !(solver.rcond() > 1e-10)) return std::nullopt;
    fit.covariance = scale.asDiagonal() * solver.solve(Matrix3d::Identity()) * scale.asDiagonal();
    fit.value = fit.covariance * side;
    const auto off = [&](const RowOval& oval) {
      return std::hypot(oval.e[0] - slope(oval, 0).dot(fit.value),
                        oval.e[1] - slope(oval, 1).dot(fit.value));
    };
    std::vector<double> all;
    for (const RowOval& oval : ovals) {
      if (oval.used) all.push_back(off(oval));
    }
    double squares = 0;
    for (const double one : all) squares += one * one;
    fit.scatter_px = std::sqrt(squares / static_cast<double>(all.size()));
    const double middle = upper_median(std::move(all));
    for (RowOval& oval : ovals) oval.used = off(oval) <= kOval.outlier * std::max(middle, oval.sd);
  }
  return fit;
}

// What rows have alike, the ink's, is no less for more of them.
double with_bias(double variance, double radius_px) {
  return std::sqrt(variance + std::pow(kOval.bias_px / radius_px, 2));
}

}  // namespace

std::optional<OvalOutline> oval_of_flights(const TrackRows& rows, const ImpactAnalysis& analysis,
                                           int width, int height) {
  std::vector<RowOval> ovals;
  double seen = 0, radii = 0, fastest = 0;
  OvalOutline found;
  std::vector<FlightRows> flights = flights_of(rows, analysis, kOval.flight);
  // Pixels that are not square bend a flight, too, so that it passes for none.
  if (flights.empty() && analysis.status == ImpactStatus::kNone && rows.size() > kOval.flight) {
    flights.push_back({0, rows.size() - 1});
  }
  for (const FlightRows& flight : flights) {
    for (std::size_t i = flight.first; i <= flight.last; ++i) {
      const TrackRow row = rows[i];
      if (!row.circle_ok || !row.motion_ok || !(row.r_px > 0)) continue;
      ++seen;
      if (!std::isfinite(row.e1_px) || !(row.e1_sd_px > 0)) continue;
      const double r = row.r_px,
                   sd = std::hypot(std::max(row.e1_sd_px, row.e2_sd_px), kOval.bias_px);
      ovals.push_back({{row.e1_px / r, row.e2_px / r}, {-row.dy_px / 2, row.dx_px / 2}, sd / r});
      radii += r;
      fastest = std::max(fastest, std::hypot(row.dx_px, row.dy_px));
      const double aside =
          std::hypot(row.cx_px - 0.5 * (width - 1), row.cy_px - 0.5 * (height - 1));
      found.aside_widths = std::max(found.aside_widths, aside / width);
    }
  }
  const auto count = static_cast<double>(ovals.size());
  if (ovals.size() < kOval.ovals || count < kOval.share * seen) return std::nullopt;
  const double radius = radii / count;
  found.frames = ovals.size();
  if (const auto rolling = fit_of(ovals, true)) {
    const double readout = rolling->value[2];
    found.readout_frames = {readout * height, std::sqrt(rolling->covariance(2, 2)) * height};
    found.speed_share = readout * fastest;
    found.follows_speed = readout > kOval.chance * std::sqrt(rolling->covariance(2, 2)) &&
                          rolling->scatter_px < kOval.steady * readout * fastest &&
                          found.readout_frames.value > kOval.least_readout &&
                          found.readout_frames.value < kOval.most_readout;
  }
  const auto fit = fit_of(std::move(ovals), false);
  if (!fit) return std::nullopt;
  const double e = std::hypot(fit->value[0], fit->value[1]);
  if (!found.follows_speed && fit->scatter_px > kOval.steady * e) return std::nullopt;
  found.stretch = {2 * e, 2 * with_bias(fit->covariance(0, 0), radius)};
  const double angle = -0.5 * std::atan2(fit->value[1], fit->value[0]);
  found.towards_rad = angle < 0 ? angle + kPi : angle;
  return found;
}

std::string oval_warning(const std::optional<OvalOutline>& oval) {
  if (!oval) return "";
  char text[420];
  if (oval->follows_speed) {
    std::snprintf(
        text, sizeof text,
        "the free ball is stretched along with its velocity, as by a rolling shutter that "
        "takes %.2f +- %.2f of a frame's time from the first row to the last: velocities "
        "are up to %.1f %% off: film with a global shutter",
        oval->readout_frames.value, oval->readout_frames.sd, 100 * oval->speed_share);
    return text;
  }
  // The outline of a sphere at the angle a off the axis is longer than wide by tan^2(a) / 2.
  const double tangent = oval->aside_widths / kOval.nearest_widths;
  const Measured& stretch = oval->stretch;
  if (stretch.value <= kOval.chance * stretch.sd + kOval.least + tangent * tangent / 2) return "";
  std::snprintf(
      text, sizeof text,
      "the free ball's outline is an ellipse, %.2f +- %.2f %% longer at %ld degrees than "
      "across, in %zu frames: pixels that are not square, a rolling shutter, a "
      "disc that is seen at an angle, or a ball that is not round; lengths and velocities "
      "hold its share of that",
      100 * stretch.value, 100 * stretch.sd, std::lround(oval->towards_rad * kDegPerRad) % 180,
      oval->frames);
  return text;
}

}  // namespace impactdic::run
