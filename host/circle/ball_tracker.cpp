#include "host/circle/ball_tracker.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "host/circle/judge_circle.h"
#include "host/circle/rim/rim_model.h"
#include "host/circle/scene/backdrop.h"
#include "host/circle/settings/judgement.h"
#include "host/circle/sphere/disc_doubt.h"

namespace impactdic::circle {
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
                         (!is_plausible(fit, radius.rough_px) ||
                          (options_.scene && !stands_out(fit, frame, radius.rough_px)));
    if (another) fit = {};
  }
  if (!options_.backdrop) return fit;
  if (fit.status == CircleStatus::kOk) {
    const CircleFit again = measure(frame, prior_found(fit.circle, radius));
    return is_plausible(again, radius.rough_px) ? again : fit;
  }
  thread_local Frame evened;  // memory only
  options_.backdrop->even(frame, evened);
  options.evened = true;
  const auto found = find_chosen_ball(evened, index, options, nullptr, choice);
  if (!found) return fit;
  const CircleFit plain = measure(frame, prior_found(*found, radius));
  // Before an evened background whatever comes is plain: arms have round ends, too.
  const bool is_ball = is_plausible(plain, radius.rough_px) &&
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
    return is_plausible(fit, radius.rough_px) && !(prior && is_grown(fit, *prior)) &&
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
  if (prior && is_shadow_of(frame, prior->predicted, found)) found = {};
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

}  // namespace impactdic::circle
