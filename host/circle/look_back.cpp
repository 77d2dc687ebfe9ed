// The first frames of a ball, which nothing before them foretells, again from those that follow.
#include <algorithm>
#include <cmath>

#include "host/circle/ball_tracker.h"
#include "host/circle/judge_circle.h"
#include "host/circle/settings/judgement.h"

namespace impactdic::circle {
namespace {

// Of the frame before two measured ones that follow each other.
CirclePrior prior_behind(const CircleFit& next, const CircleFit& after) {
  CirclePrior prior;
  const double vx = after.circle.cx_px - next.circle.cx_px;
  const double vy = after.circle.cy_px - next.circle.cy_px;
  prior.predicted = {next.circle.cx_px - vx, next.circle.cy_px - vy, next.circle.r_px};
  prior.e1_px = next.e1_px;
  prior.e2_px = next.e2_px;
  prior.bright = next.bright;
  prior.inked = next.inked;
  prior.rim_model = next.rim_model;
  prior.rim_fraction = next.rim_fraction;
  prior.centre_sd_px = kTracking.steady_px + kTracking.steady_of_step * std::hypot(vx, vy);
  prior.rim_sd_px = std::max(kTracking.rim_px, kTracking.rim_of_r * prior.predicted.r_px);
  return prior;
}

}  // namespace

void BallTracker::look_back(std::span<const Frame> frames, std::int64_t first_index,
                            std::size_t begin, std::size_t found, std::size_t end,
                            std::span<CircleFit> fits) const {
  const Radius known = radius();
  if (!known.px || end - found < kTracking.least_radii + 1) return;
  for (std::size_t k = 1; k < kTracking.least_radii + 1; ++k) {
    if (!is_plausible(fits[found + k], known.px)) return;
  }
  for (std::size_t i = found + 2; i-- > begin;) {
    CirclePrior prior = prior_behind(fits[i + 1], fits[i + 2]);
    prior.radius_px = known.px;
    prior.radius_sd_px = known.sd_px;
    prior.radius_bias_sd_px = known.bias_sd_px;
    prior.compression_axis_rad = options_.compression_axis_rad;
    const CircleFit fit = measure(frames[i], prior);
    const double off_px = std::hypot(fit.circle.cx_px - prior.predicted.cx_px,
                                     fit.circle.cy_px - prior.predicted.cy_px);
    const bool foretold = is_plausible(fit, known.px) &&
                          off_px < kTracking.back_sds * prior.centre_sd_px &&
                          fit.rim_fraction > kJudge.followed_rim * fits[i].rim_fraction;
    const std::int64_t index = first_index + static_cast<std::int64_t>(i);
    if (foretold && !is_another_ball(options_.choice.get(), index, fit.circle)) {
      fits[i] = fit;
    } else if (i < found) {
      return;
    }
  }
}

}  // namespace impactdic::circle
