// A circle before a background whose texture is known.
#include <algorithm>
#include <cmath>
#include <utility>

#include "host/circle/ball_tracker.h"
#include "host/circle/circle.h"
#include "host/circle/scene/backdrop.h"
#include "host/circle/settings/backdrop.h"
#include "host/circle/settings/judgement.h"

namespace impactdic::circle {
namespace {

double farthest_px(const CircleFit& fit, const Backdrop::Outline& from) {
  return std::max(
      {std::hypot(fit.circle.cx_px - from.circle.cx_px, fit.circle.cy_px - from.circle.cy_px),
       std::abs(fit.circle.r_px - from.circle.r_px),
       std::hypot(fit.e1_px - from.e1_px, fit.e2_px - from.e2_px)});
}

}  // namespace

CircleFit measure_circle(const Frame& frame, const CirclePrior& prior, const CircleOptions& options,
                         const Backdrop* backdrop) {
  if (backdrop == nullptr) return measure_circle(frame, prior, options);
  thread_local Frame evened;  // memory only
  CircleOptions before_evened = options;
  before_evened.evened = true;
  Backdrop::Outline about{prior.predicted, prior.e1_px, prior.e2_px};
  CircleFit fit;
  for (int round = 0; round < kBackdrop.rounds; ++round) {
    backdrop->even(frame, about, evened);
    CircleFit next = measure_circle(evened, prior, before_evened);
    if (round == 0 && next.status != CircleStatus::kOk) return next;
    // About a better place more of the rim shows.
    const bool worse = next.rim_fraction < kBackdrop.less_rim * fit.rim_fraction;
    if (next.status != CircleStatus::kOk || worse) break;
    fit = std::move(next);
    const bool settled = farthest_px(fit, about) < kBackdrop.settled_px;
    about = {fit.circle, fit.e1_px, fit.e2_px};
    if (settled) break;
  }
  // Before an even background a ball shows more of its rim than some crossings of an arc.
  if (!fit.rim_model && fit.rim_fraction < kBackdrop.least_rim) {
    return CircleFit{.bright = fit.bright};
  }
  // What is left of a texture misplaces single pieces of the rim, and a longer one by less.
  const double guessed = backdrop->guessed_share(about);
  double off_px = std::sqrt(kBackdrop.evened_of_r_px / fit.circle.r_px) *
                  std::hypot(kBackdrop.evened_sd_px, kBackdrop.guessed_sd_px * guessed);
  // Where what is guessed ends there is an edge, and no model tells it from the rim.
  if (!fit.rim_model && guessed > kBackdrop.much_guessed) {
    off_px = std::hypot(off_px, kJudge.ragged_sd_of_r * fit.circle.r_px);
  }
  for (double* sd : {&fit.cx_sd_px, &fit.cy_sd_px, &fit.r_sd_px}) *sd = std::hypot(*sd, off_px);
  return fit;
}

// Of a disc the rim shows all around before any texture, and taking that away leaves more than it
// hides; but where little of the rim shows, as of few large speckles.
CircleFit BallTracker::measure(const Frame& frame, const CirclePrior& prior) const {
  const Backdrop* const backdrop = options_.backdrop.get();
  CircleFit plain;
  if (options_.circle.sphere == false) {
    plain = measure_circle(frame, prior, options_.circle);
    const bool shows = plain.rim_model || plain.rim_fraction > kTracking.whole_rim;
    if (backdrop == nullptr || (plain.status == CircleStatus::kOk && shows)) return plain;
  }
  CircleFit evened = measure_circle(frame, prior, options_.circle, backdrop);
  const bool better = evened.rim_fraction > plain.rim_fraction;
  return better || plain.status != CircleStatus::kOk ? evened : plain;
}

}  // namespace impactdic::circle
