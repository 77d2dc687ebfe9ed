// What BallTracker knows of the free ball's radius.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "host/base/statistics.h"
#include "host/circle/ball_tracker.h"
#include "host/circle/settings/judgement.h"

namespace impactdic::circle {

std::optional<double> BallTracker::radius_px() const {
  if (memory_.radii_px.size() < kTracking.least_radii) return std::nullopt;
  return upper_median(std::vector<double>(memory_.radii_px.begin(), memory_.radii_px.end()));
}

double BallTracker::radius_sd_px() const {
  if (memory_.radii_px.size() < kTracking.least_radii) return 0;
  const double centre = *radius_px();
  std::vector<double> off;
  for (double r : memory_.radii_px) off.push_back(std::abs(r - centre));
  // The ball's distance from the camera may change a little: not below a thousandth of a radius.
  return std::hypot(kTracking.mad * upper_median(off), kTracking.radius_sd_of_r * centre);
}

// Frames share the ink under their rim and the rim's model, and so a part of their radii's errors:
// the part of their deviations that does not show as scatter.
double BallTracker::radius_bias_sd_px() const {
  const std::deque<double>&own = memory_.own_radii_px, &sds = memory_.own_radii_sd_px;
  if (own.size() < kTracking.least_radii) return 0;
  const double centre = upper_median(std::vector<double>(own.begin(), own.end()));
  const double stated = upper_median(std::vector<double>(sds.begin(), sds.end()));
  std::vector<double> off;
  for (const double r : own) off.push_back(std::abs(r - centre));
  const double scatter = kTracking.mad * upper_median(off);
  const double common = std::max(0.0, stated * stated - scatter * scatter);
  return std::sqrt(common + scatter * scatter / static_cast<double>(own.size()));
}

BallTracker::Radius BallTracker::radius() const {
  const auto learnt = radius_px();
  return {learnt, radius_sd_px(), radius_bias_sd_px(),
          learnt ? learnt : options_.scouted_radius_px};
}

void BallTracker::learn_radius(const CircleFit& fit) {
  if (fit.ellipse || fit.rim_fraction <= kTracking.whole_rim) return;
  memory_.radii_px.push_back(fit.circle.r_px);
  const bool owns = fit.own_r_sd_px > 0;  // or no other frame was asked
  memory_.own_radii_px.push_back(owns ? fit.own_r_px : fit.circle.r_px);
  memory_.own_radii_sd_px.push_back(owns ? fit.own_r_sd_px : fit.r_sd_px);
  for (auto* radii : {&memory_.radii_px, &memory_.own_radii_px, &memory_.own_radii_sd_px}) {
    if (radii->size() > kTracking.radii) radii->pop_front();
  }
}

}  // namespace impactdic::circle
