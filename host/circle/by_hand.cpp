// The ball in frames that a person has corrected.
#include <algorithm>
#include <cmath>

#include "host/circle/ball_tracker.h"
#include "host/circle/settings/judgement.h"

namespace impactdic::circle {
namespace {

double distance_px(const Circle& circle, const BallByHand& given) {
  return std::hypot(circle.cx_px - given.cx_px, circle.cy_px - given.cy_px);
}

bool is_same_size(double r_px, const BallByHand& given) {
  return std::abs(r_px - given.r_px) < kTracking.radius_tolerance * given.r_px;
}

}  // namespace

// What was followed so far is another thing where it was not expected at the circle given.
void BallTracker::forget_others(const BallByHand& given) {
  const auto expected = predict(given.frame);
  const bool same = expected && is_same_size(expected->predicted.r_px, given) &&
                    distance_px(expected->predicted, given) < kTracking.hand_of_r * given.r_px;
  if (!same) {
    std::erase_if(memory_.seen, [](const Seen& seen) { return seen.fit.by_hand == ByHand::kNo; });
  }
  const auto radius = radius_px();
  if (!radius || is_same_size(*radius, given)) return;
  memory_.radii_px.clear();
  memory_.own_radii_px.clear();
  memory_.own_radii_sd_px.clear();
}

CircleFit BallTracker::measure_by_hand(const Frame& frame, const BallByHand& given) {
  if (given.r_px == 0) return {.by_hand = ByHand::kAbsent};
  forget_others(given);
  const double hand_px = std::max(kTracking.hand_px, kTracking.hand_sd_of_r * given.r_px);
  CirclePrior prior = predict(given.frame).value_or(CirclePrior{});
  const double known_px = prior.predicted.r_px > 0 ? prior.predicted.r_px : given.r_px;
  prior.rim_sd_px.reset();
  prior.compression_axis_rad = options_.compression_axis_rad;
  // The radius of the frames before is better known than a hand draws it.
  for (const double r_px : {known_px, given.r_px}) {
    for (const double reach : {1.0, kTracking.lost_factor}) {
      prior.predicted = {given.cx_px, given.cy_px, r_px};
      prior.centre_sd_px = reach * hand_px;
      CircleFit fit = measure(frame, prior);
      fit.by_hand = ByHand::kGuided;
      if (fit.status == CircleStatus::kOk && is_same_size(fit.circle.r_px, given) &&
          distance_px(fit.circle, given) < kTracking.hand_of_r * given.r_px) {
        return fit;
      }
    }
  }
  CircleFit drawn;
  if (!memory_.seen.empty()) {
    const CircleFit& last = memory_.seen.back().fit;
    drawn.bright = last.bright;
    drawn.inked = last.inked;
    drawn.rim_model = last.rim_model;
  }
  drawn.status = CircleStatus::kOk;
  drawn.by_hand = ByHand::kDrawn;
  drawn.circle = {given.cx_px, given.cy_px, given.r_px};
  drawn.cx_sd_px = drawn.cy_sd_px = drawn.r_sd_px = hand_px;
  return drawn;
}

}  // namespace impactdic::circle
