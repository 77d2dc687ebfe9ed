// The frames between two that are measured in order: how far ahead the next one of these is
// measured, and the frames up to it, all at once.
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/base/parallel/parallel_for.h"
#include "host/circle/ball_tracker.h"
#include "host/circle/judge_circle.h"
#include "host/circle/rim/rim_model.h"
#include "host/circle/settings/judgement.h"

namespace impactdic::circle {
namespace {

// Between two measured frames, on the line or the parabola that leads from one to the other.
CirclePrior prior_between(const BallTracker::Plan::Left& left, std::int64_t index) {
  const CircleFit &a = left.from.fit, &b = left.to.fit;
  const double steps = static_cast<double>(left.to.index - left.from.index);
  const double t = static_cast<double>(index - left.from.index) / steps, bend = t * (1 - t);
  CirclePrior prior;
  prior.predicted = {std::lerp(a.circle.cx_px, b.circle.cx_px, t) - bend * left.bend_x_px,
                     std::lerp(a.circle.cy_px, b.circle.cy_px, t) - bend * left.bend_y_px,
                     std::lerp(a.circle.r_px, b.circle.r_px, t)};
  prior.e1_px = std::lerp(a.e1_px, b.e1_px, t);
  prior.e2_px = std::lerp(a.e2_px, b.e2_px, t);
  prior.bright = b.bright;
  prior.inked = b.inked;
  prior.rim_model = b.rim_model;
  prior.rim_fraction = std::min(a.rim_fraction, b.rim_fraction);
  prior.learn = false;
  prior.unlearnt = !b.rim_model;
  prior.centre_sd_px = left.centre_sd_px;
  prior.rim_sd_px = std::max(kTracking.rim_px, kTracking.rim_of_r * prior.predicted.r_px);
  return prior;
}

}  // namespace

// The last three frames that were measured, and how they foretell one that lies `ahead` of them
// where a steady force, as gravity, bends the way.
BallTracker::Bend BallTracker::bend_ahead(double ahead) const {
  Bend bend;
  if (memory_.seen.size() < 3) return bend;
  const Seen &a = memory_.seen[0], &b = memory_.seen[1], &c = memory_.seen[2];
  const auto first = static_cast<double>(b.index - a.index);
  const auto second = static_cast<double>(c.index - b.index);
  // What the velocity's change between them makes of the way ahead.
  const double frames = ahead * (ahead + second) / (first + second);
  const auto along = [&](double at_a, double at_b, double at_c) {
    return frames * ((at_c - at_b) / second - (at_b - at_a) / first);
  };
  bend.x_px = along(a.fit.circle.cx_px, b.fit.circle.cx_px, c.fit.circle.cx_px);
  bend.y_px = along(a.fit.circle.cy_px, b.fit.circle.cy_px, c.fit.circle.cy_px);
  // By the errors of the three.
  const auto sd = [](const Seen& seen) { return std::max(seen.fit.cx_sd_px, seen.fit.cy_sd_px); };
  const double of_a = frames / first, of_c = 1 + (ahead + frames) / second;
  bend.sd_px = std::hypot(of_a * sd(a), (of_c - 1 + of_a) * sd(b), of_c * sd(c));
  bend.is_told =
      bend.sd_px < kTracking.bend_sd_px && std::hypot(bend.x_px, bend.y_px) < kTracking.straight_px;
  return bend;
}

void BallTracker::follow(std::span<const Frame> frames, std::int64_t first_index,
                         std::span<CircleFit> fits) {
  complete(lead(frames, first_index, fits), frames, fits);
}

BallTracker::Plan BallTracker::lead(std::span<const Frame> frames, std::int64_t first_index,
                                    std::span<CircleFit> fits, const std::vector<bool>& repeats) {
  Plan plan;
  plan.first_index = first_index;
  for (std::size_t begin = 0; begin < frames.size(); begin += kTracking.run) {
    const std::size_t end = std::min(begin + kTracking.run, frames.size());
    std::size_t from = begin;
    for (std::size_t i = begin; i < end; ++i) {
      const std::int64_t index = first_index + static_cast<std::int64_t>(i);
      const bool by_hand = correction(index) != nullptr;
      const bool again = !by_hand && i > 0 && !repeats.empty() && repeats[i];
      if (!by_hand && !again) continue;
      if (from < i) lead_run(frames, from, i, fits, plan);
      fits[i] = again ? fits[i - 1] : track(frames[i], index);
      from = i + 1;
    }
    if (from < end) lead_run(frames, from, end, fits, plan);
  }
  plan.radius = radius();
  learn_bias();
  return plan;
}

void BallTracker::lead_run(std::span<const Frame> frames, std::size_t begin, std::size_t end,
                           std::span<CircleFit> fits, Plan& plan) {
  const std::int64_t first = plan.first_index + static_cast<std::int64_t>(begin);
  if (memory_.seen.empty() || first - memory_.seen.back().index > kTracking.longest_gap) {
    search_run(frames, plan.first_index, begin, end, fits);
  } else if (measure_ahead(frames, begin, end, fits, plan)) {
    return;
  } else if (end - begin > kTracking.shortest_run) {
    const std::size_t middle = (begin + end) / 2;
    lead_run(frames, begin, middle, fits, plan);
    lead_run(frames, middle, end, fits, plan);
  } else {
    for (std::size_t i = begin; i < end; ++i) {
      fits[i] = track(frames[i], plan.first_index + static_cast<std::int64_t>(i));
    }
  }
}

bool BallTracker::measure_ahead(std::span<const Frame> frames, std::size_t begin, std::size_t end,
                                std::span<CircleFit> fits, Plan& plan) {
  if (memory_.seen.size() < 2 || memory_.radii_px.size() < kTracking.least_radii) return false;
  const std::int64_t index = plan.first_index + static_cast<std::int64_t>(end) - 1;
  const auto steps = static_cast<double>(index - memory_.seen.back().index);
  CirclePrior prior = prior_ahead(index);
  const Bend bend = bend_ahead(steps);
  if (bend.is_told) {
    prior.predicted.cx_px += bend.x_px;
    prior.predicted.cy_px += bend.y_px;
    prior.centre_sd_px = std::min(prior.centre_sd_px, std::hypot(kTracking.between_px, bend.sd_px));
  }
  const CircleFit fit = measure(frames[end - 1], prior);
  // One that the rim model of the frames before does not show may be another thing that lies there.
  const bool unlike = is_flat(prior.rim_model.get()) && !fit.rim_model;
  if (!is_plausible(fit, prior.radius_px) || is_grown(fit, prior) || unlike) return false;
  const double off_x_px = fit.circle.cx_px - prior.predicted.cx_px;
  const double off_y_px = fit.circle.cy_px - prior.predicted.cy_px;
  const double off_px = std::hypot(off_x_px, off_y_px);
  if (off_px > kTracking.straight_px) return false;
  fits[end - 1] = fit;
  const Seen ahead{index, with_last_model(fit)};
  const Seen& last = memory_.seen.back();
  Plan::Left left{0, last, ahead, std::hypot(kTracking.between_px, kTracking.of_off * off_px)};
  if (bend.is_told) {
    // All of it, by the frame ahead too, as it bends the way since the frame before the last one.
    const auto all = static_cast<double>(index - memory_.seen[memory_.seen.size() - 2].index);
    left.bend_x_px = steps / all * (bend.x_px + off_x_px);
    left.bend_y_px = steps / all * (bend.y_px + off_y_px);
    left.centre_sd_px = std::hypot(kTracking.between_px, kTracking.of_off_bent * off_px);
  }
  for (left.frame = begin; left.frame + 1 < end; ++left.frame) plan.left.push_back(left);
  remember(fit, index);
  return true;
}

std::vector<CirclePrior> BallTracker::expected(const Plan& plan) const {
  std::vector<CirclePrior> priors;
  priors.reserve(plan.left.size());
  for (const Plan::Left& left : plan.left) {
    const std::int64_t index = plan.first_index + static_cast<std::int64_t>(left.frame);
    CirclePrior& prior = priors.emplace_back(prior_between(left, index));
    prior.radius_px = plan.radius.px;
    prior.radius_sd_px = plan.radius.sd_px;
    prior.radius_bias_sd_px = plan.radius.bias_sd_px;
    prior.compression_axis_rad = options_.compression_axis_rad;
  }
  return priors;
}

bool BallTracker::any_to_follow(const Plan& plan) const {
  // Of a ball that may be a sphere a texture behind it is taken away first.
  if (options_.backdrop && options_.circle.sphere != false) return false;
  return std::any_of(plan.left.begin(), plan.left.end(),
                     [](const Plan::Left& left) { return is_flat(left.to.fit.rim_model.get()); });
}

void BallTracker::complete(const Plan& plan, std::span<const Frame> frames,
                           std::span<CircleFit> fits,
                           std::span<const std::optional<CircleFit>> followed) const {
  const std::vector<CirclePrior> priors = expected(plan);
  const auto locate_left = [&](std::size_t k, const CircleFit* known) {
    const std::size_t frame = plan.left[k].frame;
    const std::int64_t index = plan.first_index + static_cast<std::int64_t>(frame);
    fits[frame] = locate(frames[frame], {index, priors[k], false, known}, plan.radius);
  };
  std::vector<std::size_t> others;
  for (std::size_t k = 0; k < plan.left.size(); ++k) {
    if (!followed.empty() && followed[k]) {
      locate_left(k, &*followed[k]);
    } else {
      others.push_back(k);
    }
  }
  if (others.empty()) return;
  // Alone: a thread that waits here must not take up work that waits for this.
  tbb::this_task_arena::isolate([&] {
    parallel_for(others.size(), [&](std::size_t i) { locate_left(others[i], nullptr); });
  });
}

void BallTracker::search_run(std::span<const Frame> frames, std::int64_t first_index,
                             std::size_t begin, std::size_t end, std::span<CircleFit> fits) {
  // A ball that is there is mostly there from the first frame on.
  fits[begin] = track(frames[begin], first_index + static_cast<std::int64_t>(begin));
  std::size_t next = begin + 1, found = begin;
  if (fits[begin].status != CircleStatus::kOk) {
    const Radius known = radius();
    tbb::this_task_arena::isolate([&] {
      parallel_for(end - next, [&](std::size_t k) {
        const std::size_t i = next + k;
        fits[i] = search(frames[i], first_index + static_cast<std::int64_t>(i), known);
      });
    });
    while (next < end && fits[next].status != CircleStatus::kOk) ++next;
    if (next == end) return;
    memory_.seen.clear();
    remember(fits[next], first_index + static_cast<std::int64_t>(next));
    found = next++;
  }
  for (; next < end; ++next) {
    fits[next] = track(frames[next], first_index + static_cast<std::int64_t>(next));
  }
  look_back(frames, first_index, begin, found, end, fits);
}

}  // namespace impactdic::circle
