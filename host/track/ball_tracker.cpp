#include "host/track/ball_tracker.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "host/base/error.h"

namespace impactdic {
namespace {

constexpr std::size_t kRadii = 101;  // frames over which the radius is learnt
constexpr std::size_t kLeastRadii = 3;
constexpr double kWholeRim = 0.3;         // share of the rim that a radius is learnt from
constexpr double kSteady_px = 0.3;        // scatter of a prediction from two frames
constexpr double kSteadyOfStep = 0.05;    // and of the velocity, an impact apart
constexpr std::int64_t kLongestGap = 5;   // frames without a ball before the picture is searched
constexpr double kRadiusTolerance = 0.2;  // of the radius: another circle, not this ball

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

void BallTrackerOptions::validate() const { circle.validate(); }

BallTracker::BallTracker(BallTrackerOptions options) : options_(std::move(options)) {
  options_.validate();
}

std::optional<double> BallTracker::radius_px() const {
  if (radii_px_.size() < kLeastRadii) return std::nullopt;
  return median({radii_px_.begin(), radii_px_.end()});
}

double BallTracker::radius_sd_px() const {
  if (radii_px_.size() < kLeastRadii) return 0;
  const double centre = *radius_px();
  std::vector<double> off;
  for (double r : radii_px_) off.push_back(std::abs(r - centre));
  // The ball's distance from the camera may change a little: not below a thousandth of a radius.
  return std::hypot(1.48 * median(off), 2e-4 * centre);
}

std::optional<CirclePrior> BallTracker::predict(std::int64_t index) const {
  if (seen_.empty()) return std::nullopt;
  const Seen& last = seen_.back();
  const double gap = static_cast<double>(std::abs(index - last.index));
  if (gap > kLongestGap) return std::nullopt;
  CirclePrior prior;
  prior.predicted = last.fit.circle;
  prior.bright = last.fit.bright;
  prior.e1_px = last.fit.e1_px;
  prior.e2_px = last.fit.e2_px;
  const double r = last.fit.circle.r_px;
  // Without a velocity the ball may have gone far; with one, an impact may have changed it.
  prior.centre_sd_px = std::max(3.0, 0.05 * r) * std::max(gap, 1.0);
  if (seen_.size() > 1) {
    const Seen& before = seen_[seen_.size() - 2];
    const double steps = static_cast<double>(last.index - before.index);
    const double vx = (last.fit.circle.cx_px - before.fit.circle.cx_px) / steps;
    const double vy = (last.fit.circle.cy_px - before.fit.circle.cy_px) / steps;
    const double ahead = static_cast<double>(index - last.index);
    prior.predicted.cx_px += vx * ahead;
    prior.predicted.cy_px += vy * ahead;
    prior.centre_sd_px = (kSteady_px + kSteadyOfStep * std::hypot(vx, vy)) * std::max(gap, 1.0);
    prior.rim_sd_px = std::max(0.3, 0.005 * r) * std::max(gap, 1.0);
  }
  if (const auto radius = radius_px()) {
    prior.radius_px = *radius;
    prior.radius_sd_px = radius_sd_px();
  }
  prior.compression_axis_rad = options_.compression_axis_rad;
  return prior;
}

std::optional<double> BallTracker::rough_radius_px() const {
  const auto learnt = radius_px();
  return learnt ? learnt : options_.scouted_radius_px;
}

bool BallTracker::plausible(const CircleFit& fit) const {
  if (fit.status != CircleStatus::ok) return false;
  const auto radius = rough_radius_px();
  return !radius || std::abs(fit.circle.r_px - *radius) < kRadiusTolerance * *radius;
}

void BallTracker::remember(const CircleFit& fit, std::int64_t index) {
  if (!seen_.empty() && seen_.back().index == index) seen_.pop_back();
  seen_.push_back({index, fit});
  if (seen_.size() > 2) seen_.pop_front();
  if (!fit.ellipse && fit.rim_fraction > kWholeRim) {
    radii_px_.push_back(fit.circle.r_px);
    if (radii_px_.size() > kRadii) radii_px_.pop_front();
  }
}

void BallTracker::hint(const CircleFit& fit, std::int64_t index) {
  if (fit.status == CircleStatus::ok) remember(fit, index);
}

CircleFit BallTracker::track(const Frame& frame, std::int64_t index) {
  CircleFit fit;
  if (const auto prior = predict(index)) {
    fit = measure_circle(frame, *prior, options_.circle);
    if (!plausible(fit) && fit.status != CircleStatus::out_of_view) {
      // A stronger change than predicted: look farther before looking everywhere.
      CirclePrior wide = *prior;
      wide.centre_sd_px = std::max(3.0, 3 * prior->centre_sd_px);
      wide.rim_sd_px.reset();
      fit = measure_circle(frame, wide, options_.circle);
    }
    if (plausible(fit)) {
      remember(fit, index);
      return fit;
    }
    if (fit.status == CircleStatus::out_of_view) return fit;
  }
  CircleOptions options = options_.circle;
  const auto rough = rough_radius_px();
  if (rough && !options.radius_range_px) {
    options.radius_range_px = {(1 - kRadiusTolerance) * *rough, (1 + kRadiusTolerance) * *rough};
  }
  const auto found = find_ball(frame, options);
  if (!found) {
    fit = {};
    return fit;
  }
  CirclePrior prior;
  prior.predicted = *found;
  prior.centre_sd_px = 1;
  if (const auto radius = radius_px()) {
    prior.radius_px = *radius;
    prior.radius_sd_px = radius_sd_px();
  }
  prior.compression_axis_rad = options_.compression_axis_rad;
  fit = measure_circle(frame, prior, options_.circle);
  if (plausible(fit)) {
    seen_.clear();
    remember(fit, index);
  } else if (fit.status == CircleStatus::ok) {
    fit = {};
  }
  return fit;
}

}  // namespace impactdic
