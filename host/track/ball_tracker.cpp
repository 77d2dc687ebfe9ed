#include "host/track/ball_tracker.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

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

constexpr std::size_t kRun = 8;     // frames measured in parallel behind one
constexpr double kStraight_px = 1;  // from the line, over that many frames

// The circle is the ball's as far as its radius tells.
bool plausible(const CircleFit& fit, const std::optional<double>& radius_px) {
  return fit.status == CircleStatus::ok &&
         (!radius_px || std::abs(fit.circle.r_px - *radius_px) < kRadiusTolerance * *radius_px);
}

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
  const double gap = static_cast<double>(std::abs(index - seen_.back().index));
  if (gap > kLongestGap) return std::nullopt;
  CirclePrior prior = prior_ahead(index);
  prior.centre_sd_px *= std::max(gap, 1.0);
  if (prior.rim_sd_px) *prior.rim_sd_px *= std::max(gap, 1.0);
  return prior;
}

// As exact as for the next frame, however far ahead.
CirclePrior BallTracker::prior_ahead(std::int64_t index) const {
  const Seen& last = seen_.back();
  CirclePrior prior;
  prior.predicted = last.fit.circle;
  prior.bright = last.fit.bright;
  prior.e1_px = last.fit.e1_px;
  prior.e2_px = last.fit.e2_px;
  const double r = last.fit.circle.r_px;
  // Without a velocity the ball may have gone far; with one, an impact may have changed it.
  prior.centre_sd_px = std::max(3.0, 0.05 * r);
  if (seen_.size() > 1) {
    const Seen& before = seen_[seen_.size() - 2];
    const double steps = static_cast<double>(last.index - before.index);
    const double vx = (last.fit.circle.cx_px - before.fit.circle.cx_px) / steps;
    const double vy = (last.fit.circle.cy_px - before.fit.circle.cy_px) / steps;
    const double ahead = static_cast<double>(index - last.index);
    prior.predicted.cx_px += vx * ahead;
    prior.predicted.cy_px += vy * ahead;
    prior.centre_sd_px = kSteady_px + kSteadyOfStep * std::hypot(vx, vy);
    prior.rim_sd_px = std::max(0.3, 0.005 * r);
  }
  if (const auto radius = radius_px()) {
    prior.radius_px = *radius;
    prior.radius_sd_px = radius_sd_px();
  }
  prior.compression_axis_rad = options_.compression_axis_rad;
  return prior;
}

CirclePrior BallTracker::prior_between(const Steady& steady, std::int64_t index,
                                       const Radius& radius) const {
  const CircleFit &a = steady.from.fit, &b = steady.to.fit;
  const double steps = static_cast<double>(steady.to.index - steady.from.index);
  const double t = static_cast<double>(index - steady.from.index) / steps;
  CirclePrior prior;
  prior.predicted = {std::lerp(a.circle.cx_px, b.circle.cx_px, t),
                     std::lerp(a.circle.cy_px, b.circle.cy_px, t),
                     std::lerp(a.circle.r_px, b.circle.r_px, t)};
  prior.e1_px = std::lerp(a.e1_px, b.e1_px, t);
  prior.e2_px = std::lerp(a.e2_px, b.e2_px, t);
  prior.bright = b.bright;
  prior.centre_sd_px =
      kSteady_px +
      kSteadyOfStep * std::hypot(b.circle.cx_px - a.circle.cx_px, b.circle.cy_px - a.circle.cy_px) /
          steps;
  prior.rim_sd_px = std::max(0.3, 0.005 * prior.predicted.r_px);
  prior.radius_px = radius.px;
  prior.radius_sd_px = radius.sd_px;
  prior.compression_axis_rad = options_.compression_axis_rad;
  return prior;
}

BallTracker::Radius BallTracker::radius() const {
  const auto learnt = radius_px();
  return {learnt, radius_sd_px(), learnt ? learnt : options_.scouted_radius_px};
}

void BallTracker::learn_radius(const CircleFit& fit) {
  if (fit.ellipse || fit.rim_fraction <= kWholeRim) return;
  radii_px_.push_back(fit.circle.r_px);
  if (radii_px_.size() > kRadii) radii_px_.pop_front();
}

void BallTracker::remember(const CircleFit& fit, std::int64_t index) {
  if (!seen_.empty() && seen_.back().index == index) seen_.pop_back();
  seen_.push_back({index, fit});
  if (seen_.size() > 2) seen_.pop_front();
  learn_radius(fit);
}

CircleFit BallTracker::search(const Frame& frame, const Radius& radius) const {
  CircleOptions options = options_.circle;
  if (radius.rough_px && !options.radius_range_px) {
    options.radius_range_px = {(1 - kRadiusTolerance) * *radius.rough_px,
                               (1 + kRadiusTolerance) * *radius.rough_px};
  }
  const auto found = find_ball(frame, options);
  if (!found) return {};
  CirclePrior prior;
  prior.predicted = *found;
  prior.centre_sd_px = 1;
  if (radius.px) {
    prior.radius_px = radius.px;
    prior.radius_sd_px = radius.sd_px;
  }
  prior.compression_axis_rad = options_.compression_axis_rad;
  const CircleFit fit = measure_circle(frame, prior, options_.circle);
  const bool another = fit.status == CircleStatus::ok && !plausible(fit, radius.rough_px);
  return another ? CircleFit{} : fit;
}

CircleFit BallTracker::locate(const Frame& frame, const std::optional<CirclePrior>& prior,
                              const Radius& radius, bool* searched) const {
  if (prior) {
    CircleFit fit = measure_circle(frame, *prior, options_.circle);
    if (!plausible(fit, radius.rough_px) && fit.status != CircleStatus::out_of_view) {
      // A stronger change than predicted: look farther before looking everywhere.
      CirclePrior wide = *prior;
      wide.centre_sd_px = std::max(3.0, 3 * prior->centre_sd_px);
      wide.rim_sd_px.reset();
      fit = measure_circle(frame, wide, options_.circle);
    }
    if (plausible(fit, radius.rough_px) || fit.status == CircleStatus::out_of_view) return fit;
  }
  if (searched != nullptr) *searched = true;
  return search(frame, radius);
}

CircleFit BallTracker::track(const Frame& frame, std::int64_t index) {
  bool searched = false;
  const CircleFit fit = locate(frame, predict(index), radius(), &searched);
  if (fit.status != CircleStatus::ok) return fit;
  if (searched) seen_.clear();
  remember(fit, index);
  return fit;
}

void BallTracker::follow(std::span<const Frame> frames, std::int64_t first_index,
                         std::span<CircleFit> fits) {
  std::vector<Steady> steady;
  for (std::size_t begin = 0; begin < frames.size(); begin += kRun) {
    const std::size_t end = std::min(begin + kRun, frames.size());
    const std::int64_t first = first_index + static_cast<std::int64_t>(begin);
    if (seen_.empty() || first - seen_.back().index > kLongestGap) {
      search_run(frames, first_index, begin, end, fits);
    } else if (!look_ahead(frames, first_index, begin, end, fits, steady)) {
      for (std::size_t i = begin; i < end; ++i) {
        fits[i] = track(frames[i], first_index + static_cast<std::int64_t>(i));
      }
    }
  }
  measure_between(frames, first_index, steady, fits);
}

bool BallTracker::look_ahead(std::span<const Frame> frames, std::int64_t first_index,
                             std::size_t begin, std::size_t end, std::span<CircleFit> fits,
                             std::vector<Steady>& steady) {
  if (seen_.size() < 2 || radii_px_.size() < kLeastRadii) return false;
  const std::int64_t index = first_index + static_cast<std::int64_t>(end) - 1;
  const CirclePrior prior = prior_ahead(index);
  const CircleFit fit = measure_circle(frames[end - 1], prior, options_.circle);
  if (!plausible(fit, prior.radius_px)) return false;
  if (std::hypot(fit.circle.cx_px - prior.predicted.cx_px,
                 fit.circle.cy_px - prior.predicted.cy_px) > kStraight_px) {
    return false;
  }
  fits[end - 1] = fit;
  steady.push_back({seen_.back(), {index, fit}, first_index + static_cast<std::int64_t>(begin)});
  remember(fit, index);
  return true;
}

void BallTracker::search_run(std::span<const Frame> frames, std::int64_t first_index,
                             std::size_t begin, std::size_t end, std::span<CircleFit> fits) {
  // A ball that is there is mostly there from the first frame on.
  fits[begin] = track(frames[begin], first_index + static_cast<std::int64_t>(begin));
  std::size_t next = begin + 1;
  if (fits[begin].status != CircleStatus::ok) {
    const Radius known = radius();
    tbb::this_task_arena::isolate([&] {
      tbb::parallel_for(next, end, [&](std::size_t i) { fits[i] = search(frames[i], known); });
    });
    while (next < end && fits[next].status != CircleStatus::ok) ++next;
    if (next == end) return;
    seen_.clear();
    remember(fits[next], first_index + static_cast<std::int64_t>(next));
    ++next;
  }
  for (; next < end; ++next) {
    fits[next] = track(frames[next], first_index + static_cast<std::int64_t>(next));
  }
}

void BallTracker::measure_between(std::span<const Frame> frames, std::int64_t first_index,
                                  std::span<const Steady> steady, std::span<CircleFit> fits) {
  struct Task {
    std::size_t frame;
    const Steady* steady;
  };
  std::vector<Task> tasks;
  for (const Steady& run : steady) {
    for (std::int64_t index = run.first; index < run.to.index; ++index) {
      tasks.push_back({static_cast<std::size_t>(index - first_index), &run});
    }
  }
  const Radius known = radius();
  // Alone: a thread that waits here must not take up work that waits for this.
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(std::size_t{0}, tasks.size(), [&](std::size_t k) {
      const auto& [at, run] = tasks[k];
      const std::int64_t index = first_index + static_cast<std::int64_t>(at);
      fits[at] = locate(frames[at], prior_between(*run, index, known), known);
    });
  });
  for (const Task& task : tasks) {
    if (fits[task.frame].status == CircleStatus::ok) learn_radius(fits[task.frame]);
  }
}

}  // namespace impactdic
