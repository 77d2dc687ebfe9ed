// From a frame and what is known of it to a measured circle: search, trace, fit.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "host/base/error.h"
#include "host/base/units.h"
#include "host/track/circle.h"
#include "host/track/rim.h"

namespace impactdic {
namespace {

constexpr double kRimInView = 0.35;  // less of the rim than this in the picture: out of view
constexpr double kLeastArc = 0.12;   // share of the rim's sectors that must hold points
constexpr int kLeastPoints = 24;
constexpr double kDense = 0.6;    // share of inked points above which a sharp kernel is better
constexpr double kRetrace = 0.1;  // px; a fit farther from its rays' rim is traced again

double distance(const Rim& a, const Rim& b) {
  return std::hypot(a.cx - b.cx, a.cy - b.cy) + std::abs(a.r - b.r) +
         std::hypot(a.e1 - b.e1, a.e2 - b.e2);
}

// See Circle::free_px. Ink on the rim makes gaps too: those are narrow.
double free_distance(const RimTrace& trace, const Rim& rim) {
  constexpr double kNarrow = 20 * kRadPerDeg, kOnRimPx = 3;
  std::vector<double> angles;
  for (const RimPoint& point : trace.points) {
    if (std::abs(point.excess) < kOnRimPx) angles.push_back(std::atan2(point.sin, point.cos));
  }
  if (angles.empty()) return 0;
  std::sort(angles.begin(), angles.end());
  double widest = angles.front() + 2 * kPi - angles.back();
  for (std::size_t i = 1; i < angles.size(); ++i) {
    widest = std::max(widest, angles[i] - angles[i - 1]);
  }
  if (widest < kNarrow) return rim.r;
  return rim.r * std::max(0.0, std::cos(widest / 2));
}

void validate(const Frame& frame, const CirclePrior& prior, const CircleOptions& options) {
  options.validate();
  if (!(prior.predicted.r_px > 1) || !(prior.centre_sd_px >= 0)) {
    throw InvalidArgument("a circle's prior needs a radius above 1 px and a scatter >= 0");
  }
  if (frame.width() < 8 || frame.height() < 8) {
    throw InvalidArgument("a picture for a circle must be at least 8x8 pixels");
  }
}

}  // namespace

const char* to_string(CircleStatus status) {
  switch (status) {
    case CircleStatus::ok:
      return "ok";
    case CircleStatus::no_ball:
      return "no_ball";
    case CircleStatus::out_of_view:
      return "out_of_view";
  }
  return "";
}

void CircleOptions::validate() const {
  if (rays < 64 || rays > 16384) {
    throw InvalidArgument("rays must be 64 to 16384", "CircleOptions::rays");
  }
  if (radius_range_px &&
      !(radius_range_px->first >= 3 && radius_range_px->second > radius_range_px->first)) {
    throw InvalidArgument("the radius range must be LO:HI with 3 <= LO < HI", "--radius-px");
  }
}

CircleFit measure_circle(const Frame& frame, const CirclePrior& prior,
                         const CircleOptions& options) {
  validate(frame, prior, options);
  CircleFit result;
  const RimSearch search = search_rim(frame, prior, options);
  result.bright = search.bright;
  if (search.in_view < kRimInView) {
    result.status = CircleStatus::out_of_view;
    return result;
  }
  if (!search.found) return result;

  thread_local RimTrace trace;  // memory only
  RimFit fit;
  fit.rim = search.rim;
  // Ink leaves the search too far off for a single trace: then the first one is a coarse one.
  bool sharp = prior.inked, coarse = prior.inked;
  int rays = options.rays;
  for (int pass = 0; pass < 4; ++pass) {
    const Rim rim = fit.rim;
    rays = coarse ? std::max(options.rays / 3, 64) : options.rays;
    trace_rim(frame, rim, search.bright, search.blur_px, sharp, rays, trace);
    fit = fit_rim(trace, rim, prior, options.allow_ellipse);
    if (!fit.ok) break;
    if (std::exchange(coarse, false)) continue;
    const bool sharpen = !sharp && fit.inked > kDense;
    if (!sharpen && distance(fit.rim, rim) < kRetrace) break;
    sharp |= sharpen;
  }
  if (trace.rays_in_view < kRimInView * rays) {
    result.status = CircleStatus::out_of_view;
    return result;
  }
  if (!fit.ok || fit.points < kLeastPoints || fit.arc < kLeastArc) return result;
  if (options.radius_range_px &&
      (fit.rim.r < options.radius_range_px->first || fit.rim.r > options.radius_range_px->second)) {
    return result;
  }

  // A blurred disc crosses its half level inside its rim: at R − σ²/2R (mean of the Rice
  // distribution).
  const double shrink = trace.edge_sigma_px * trace.edge_sigma_px / (2 * fit.rim.r);
  result.circle = {fit.rim.cx, fit.rim.cy, fit.rim.r + shrink, free_distance(trace, fit.rim)};
  result.cx_sd_px = fit.sd[0];
  result.cy_sd_px = fit.sd[1];
  result.r_sd_px = fit.sd[2];
  result.ellipse = fit.ellipse;
  result.e1_px = fit.rim.e1;
  result.e2_px = fit.rim.e2;
  result.e1_sd_px = fit.sd[3];
  result.e2_sd_px = fit.sd[4];
  result.inked = fit.inked > kDense;
  result.residual_px = fit.residual_px;
  result.rim_points = fit.points;
  result.rim_fraction = static_cast<double>(fit.points) / options.rays;
  const bool centre_in = fit.rim.cx >= 0 && fit.rim.cy >= 0 && fit.rim.cx <= frame.width() - 1 &&
                         fit.rim.cy <= frame.height() - 1;
  result.status = centre_in ? CircleStatus::ok : CircleStatus::out_of_view;
  return result;
}

}  // namespace impactdic
