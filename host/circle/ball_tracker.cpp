#include "host/circle/ball_tracker.h"

#include <impactdic/error.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "host/base/parallel/parallel_for.h"
#include "host/circle/rim/rim_model.h"
#include "host/circle/rim_in_view.h"
#include "host/circle/scene/backdrop.h"
#include "host/circle/settings/judgement.h"
#include "host/circle/sphere/disc_doubt.h"

namespace impactdic::circle {
namespace {

bool is_flat(const RimModel* model) { return model && model->surface() == Surface::kFlat; }

// The circle is the ball's as far as its radius tells.
bool plausible(const CircleFit& fit, const std::optional<double>& radius_px) {
  return fit.status == CircleStatus::kOk &&
         (!radius_px ||
          std::abs(fit.circle.r_px - *radius_px) < kTracking.radius_tolerance * *radius_px);
}

// Whether a circle is larger than a ball grows from a frame to the next: a shadow beside it, or
// another thing, is taken in.
bool is_grown(const CircleFit& fit, const CirclePrior& prior) {
  const double last_px = prior.predicted.r_px + std::hypot(prior.e1_px, prior.e2_px);
  const double most_px = kTracking.most_growth * std::max(last_px, prior.radius_px.value_or(0));
  return fit.circle.r_px - kTracking.growth_sds * fit.r_sd_px > most_px;
}

// Between two measured frames, on the parabola that a steady force makes of the way.
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
  prior.centre_sd_px = std::hypot(kTracking.between_px, kTracking.between_of_off * left.off_px);
  prior.rim_sd_px = std::max(kTracking.rim_px, kTracking.rim_of_r * prior.predicted.r_px);
  return prior;
}

}  // namespace

void BallTrackerOptions::validate() const { circle.validate(); }

BallTracker::BallTracker(BallTrackerOptions options) : options_(std::move(options)) {
  options_.validate();
}

std::optional<CirclePrior> BallTracker::predict(std::int64_t index) const {
  if (memory_.seen.empty()) return std::nullopt;
  const double gap = static_cast<double>(std::abs(index - memory_.seen.back().index));
  if (gap > kTracking.longest_gap) return std::nullopt;
  CirclePrior prior = prior_ahead(index);
  prior.centre_sd_px *= std::max(gap, 1.0);
  if (prior.rim_sd_px) *prior.rim_sd_px *= std::max(gap, 1.0);
  return prior;
}

// As exact as for the next frame, however far ahead.
CirclePrior BallTracker::prior_ahead(std::int64_t index) const {
  const Seen& last = memory_.seen.back();
  CirclePrior prior;
  prior.predicted = last.fit.circle;
  // Of a circle that was only drawn the polarity is not known.
  if (last.fit.by_hand != ByHand::kDrawn || last.fit.rim_model) prior.bright = last.fit.bright;
  prior.inked = last.fit.inked;
  prior.rim_model = last.fit.rim_model;
  prior.rim_fraction = last.fit.rim_fraction;
  prior.learn = index >= memory_.next_learning;
  prior.unlearnt = !prior.learn && !prior.rim_model;
  prior.e1_px = last.fit.e1_px;
  prior.e2_px = last.fit.e2_px;
  const double r = last.fit.circle.r_px;
  // Without a velocity the ball may have gone far; with one, an impact may have changed it.
  prior.centre_sd_px = std::max(kTracking.first_px, kTracking.first_of_r * r);
  if (memory_.seen.size() > 1) {
    const Seen& before = memory_.seen[memory_.seen.size() - 2];
    const double steps = static_cast<double>(last.index - before.index);
    const double vx = (last.fit.circle.cx_px - before.fit.circle.cx_px) / steps;
    const double vy = (last.fit.circle.cy_px - before.fit.circle.cy_px) / steps;
    const double ahead = static_cast<double>(index - last.index);
    const auto [bend_x, bend_y] = ahead == 1 ? fall() : std::pair(0.0, 0.0);
    prior.predicted.cx_px += vx * ahead + bend_x;
    prior.predicted.cy_px += vy * ahead + bend_y;
    prior.centre_sd_px = kTracking.steady_px + kTracking.steady_of_step * std::hypot(vx, vy);
    prior.rim_sd_px = std::max(kTracking.rim_px, kTracking.rim_of_r * r);
  }
  if (const auto radius = radius_px()) {
    prior.radius_px = *radius;
    prior.radius_sd_px = radius_sd_px();
    prior.radius_bias_sd_px = radius_bias_sd_px();
  }
  prior.compression_axis_rad = options_.compression_axis_rad;
  return prior;
}

// By how much each step is longer than the one before, px, where the last three frames show a fall.
std::pair<double, double> BallTracker::fall() const {
  if (memory_.seen.size() < 3) return {0, 0};
  const Seen &a = memory_.seen[0], &b = memory_.seen[1], &c = memory_.seen[2];
  if (b.index != a.index + 1 || c.index != b.index + 1) return {0, 0};
  const double x = c.fit.circle.cx_px - 2 * b.fit.circle.cx_px + a.fit.circle.cx_px;
  const double y = c.fit.circle.cy_px - 2 * b.fit.circle.cy_px + a.fit.circle.cy_px;
  const double bend = std::hypot(x, y);
  if (bend < kTracking.falls_px || bend > kTracking.falls_of_r * c.fit.circle.r_px) return {0, 0};
  return {x, y};
}

// Some frames ahead, where the last three that were measured show a steady force, as gravity.
CirclePrior BallTracker::prior_steady(std::int64_t index) const {
  CirclePrior prior = prior_ahead(index);
  if (memory_.seen.size() < 3) return prior;
  const Seen &a = memory_.seen[0], &b = memory_.seen[1], &c = memory_.seen[2];
  const auto first = static_cast<double>(b.index - a.index);
  const auto second = static_cast<double>(c.index - b.index);
  const auto ahead = static_cast<double>(index - c.index);
  // The second difference over half of the time that it is of: the change of the velocity a frame.
  const auto bend = [&](double at_a, double at_b, double at_c) {
    return ((at_c - at_b) / second - (at_b - at_a) / first) / (0.5 * (first + second));
  };
  const double x = bend(a.fit.circle.cx_px, b.fit.circle.cx_px, c.fit.circle.cx_px);
  const double y = bend(a.fit.circle.cy_px, b.fit.circle.cy_px, c.fit.circle.cy_px);
  const double frames = 0.5 * ahead * (ahead + second);
  if (!(std::hypot(x, y) * frames < kTracking.straight_px)) return prior;
  prior.predicted.cx_px += x * frames;
  prior.predicted.cy_px += y * frames;
  prior.centre_sd_px = std::min(prior.centre_sd_px, kTracking.steady_bend_px);
  return prior;
}

void BallTracker::learn_bias() {
  if (memory_.rim_bias || !options_.radius_by_turns || memory_.seen.empty()) return;
  if (memory_.radii_px.size() < kTracking.least_radii) return;
  CircleFit like = memory_.seen.back().fit;
  doubt_disc(like);
  const std::vector<double> radii(memory_.radii_px.begin(), memory_.radii_px.end());
  memory_.rim_bias = rim_bias(radii, like, *options_.radius_by_turns);
}

// A ball in contact may show too little of its rim in one frame; in the next its model may hold,
// and its shape about as before.
CircleFit BallTracker::with_last_model(CircleFit fit) const {
  if (fit.rim_model || memory_.seen.empty()) return fit;
  const CircleFit& last = memory_.seen.back().fit;
  if (!last.rim_model || !(fit.ellipse || last.ellipse)) return fit;
  fit.rim_model = last.rim_model;
  if (is_flat(last.rim_model.get()) || !last.ellipse) return fit;
  fit.circle.r_px = last.circle.r_px;
  fit.ellipse = true;
  fit.e1_px = last.e1_px;
  fit.e2_px = last.e2_px;
  return fit;
}

void BallTracker::remember(const CircleFit& fit, std::int64_t index) {
  if (!memory_.seen.empty() && memory_.seen.back().index == index) memory_.seen.pop_back();
  memory_.seen.push_back({index, with_last_model(fit)});
  if (memory_.seen.size() > 3) memory_.seen.pop_front();
  // Where the rim model could not be learnt it is tried again, but not in every frame.
  if (!memory_.seen.back().fit.rim_model && index >= memory_.next_learning) {
    memory_.next_learning = index + kTracking.learn_every;
  }
  learn_radius(fit);
}

CircleFit BallTracker::search(const Frame& frame, std::int64_t index, const Radius& radius) const {
  CircleOptions options = options_.circle;
  if (radius.rough_px && !options.radius_range_px) {
    options.radius_range_px = {(1 - kTracking.radius_tolerance) * *radius.rough_px,
                               (1 + kTracking.radius_tolerance) * *radius.rough_px};
  }
  const BallChoice* choice = options_.choice.get();
  CircleFit fit;
  if (const auto found = find_chosen_ball(frame, index, options, options_.scene.get(), choice)) {
    fit = measure_circle(frame, prior_found(*found, radius), options_.circle);
    const bool another = fit.status == CircleStatus::kOk &&
                         (!plausible(fit, radius.rough_px) ||
                          (options_.scene && !stands_out(fit, frame, radius.rough_px)));
    if (another) fit = {};
  }
  if (!options_.backdrop) return fit;
  if (fit.status == CircleStatus::kOk) {
    const CircleFit again = measure(frame, prior_found(fit.circle, radius));
    return plausible(again, radius.rough_px) ? again : fit;
  }
  thread_local Frame evened;  // memory only
  options_.backdrop->even(frame, evened);
  options.evened = true;
  const auto found = find_chosen_ball(evened, index, options, nullptr, choice);
  if (!found) return fit;
  const CircleFit plain = measure(frame, prior_found(*found, radius));
  // Before an evened background whatever comes is plain: arms have round ends, too.
  const bool is_ball = plausible(plain, radius.rough_px) &&
                       rim_in_view(plain, frame) >= kTracking.plain_rim && is_round(plain);
  return is_ball ? plain : fit;
}

CirclePrior BallTracker::prior_found(const Circle& found, const Radius& radius) const {
  CirclePrior prior;
  prior.predicted = found;
  prior.centre_sd_px = kTracking.found_sd_px;
  if (radius.px) {
    prior.radius_px = radius.px;
    prior.radius_sd_px = radius.sd_px;
    prior.radius_bias_sd_px = radius.bias_sd_px;
  }
  prior.compression_axis_rad = options_.compression_axis_rad;
  return prior;
}

CircleFit BallTracker::locate(const Frame& frame, const Place& place, const Radius& radius,
                              bool* searched) const {
  const std::optional<CirclePrior>& prior = place.prior;
  // Where it was not seen just before it may have bounced: any arc may lie where it would be.
  const bool was_lost = place.was_lost;
  // Little of a rim where nothing ever moves: the ball has gone.
  const auto is_ball = [&](const CircleFit& fit) {
    return plausible(fit, radius.rough_px) && !(prior && is_grown(fit, *prior)) &&
           (!was_lost || stands_out(fit, frame, radius.rough_px)) &&
           (fit.rim_fraction >= kTracking.plain_rim ||
            !stands_still(options_.scene.get(), frame, fit.circle));
  };
  bool left = false;
  if (prior) {
    CircleFit fit = place.followed ? *place.followed : measure(frame, *prior);
    if (!is_ball(fit) && fit.status != CircleStatus::kOutOfView) {
      // A stronger change than predicted: search farther before searching everywhere.
      CirclePrior wide = *prior;
      wide.centre_sd_px = std::max(kTracking.lost_px, kTracking.lost_factor * prior->centre_sd_px);
      wide.rim_sd_px.reset();
      fit = measure(frame, wide);
      if (!is_ball(fit) && fit.status != CircleStatus::kOutOfView) {
        wide.centre_sd_px = std::max(wide.centre_sd_px, kTracking.lost_of_r * wide.predicted.r_px);
        fit = measure(frame, wide);
      }
    }
    if (is_ball(fit)) return fit;
    left = fit.status == CircleStatus::kOutOfView;
    if (left && !was_lost) return fit;
  }
  if (searched != nullptr) *searched = true;
  CircleFit found = search(frame, place.index, radius);
  if (left && found.status != CircleStatus::kOk) found.status = CircleStatus::kOutOfView;
  return found;
}

const BallByHand* BallTracker::correction(std::int64_t index) const {
  const auto at =
      std::lower_bound(options_.by_hand.begin(), options_.by_hand.end(), index,
                       [](const BallByHand& ball, std::int64_t i) { return ball.frame < i; });
  return at != options_.by_hand.end() && at->frame == index ? &*at : nullptr;
}

CircleFit BallTracker::track(const Frame& frame, std::int64_t index) {
  if (const BallByHand* given = correction(index)) {
    const CircleFit fit = measure_by_hand(frame, *given);
    if (fit.status == CircleStatus::kOk) remember(fit, index);
    return fit;
  }
  bool searched = false;
  const bool was_lost = !memory_.seen.empty() && index > memory_.seen.back().index + 1;
  const CircleFit fit = locate(frame, {index, predict(index), was_lost}, radius(), &searched);
  if (fit.status != CircleStatus::kOk) return fit;
  if (searched) memory_.seen.clear();
  remember(fit, index);
  return fit;
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
  const CirclePrior prior = prior_steady(index);
  const CircleFit fit = measure(frames[end - 1], prior);
  // One that the rim model of the frames before does not show may be another thing that lies there.
  const bool unlike = is_flat(prior.rim_model.get()) && !fit.rim_model;
  if (!plausible(fit, prior.radius_px) || is_grown(fit, prior) || unlike) return false;
  const double off_px = std::hypot(fit.circle.cx_px - prior.predicted.cx_px,
                                   fit.circle.cy_px - prior.predicted.cy_px);
  if (off_px > kTracking.straight_px) return false;
  fits[end - 1] = fit;
  const Seen ahead{index, with_last_model(fit)};
  const Seen &last = memory_.seen.back(), &before = memory_.seen[memory_.seen.size() - 2];
  // By a steady force, which has bent the way since `before`.
  const auto steps = static_cast<double>(index - last.index);
  const auto first = static_cast<double>(last.index - before.index);
  const auto bend = [&](double at_before, double at_last, double at_ahead) {
    const double off = at_ahead - at_last - (at_last - at_before) * steps / first;
    return off * steps / (steps + first);
  };
  const Circle &a = before.fit.circle, &b = last.fit.circle, &c = fit.circle;
  const double x = bend(a.cx_px, b.cx_px, c.cx_px), y = bend(a.cy_px, b.cy_px, c.cy_px);
  for (std::size_t i = begin; i + 1 < end; ++i) plan.left.push_back({i, last, ahead, off_px, x, y});
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
  return std::any_of(plan.left.begin(), plan.left.end(), [](const Plan::Left& left) {
    return is_flat(left.to.fit.rim_model.get());
  });
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
