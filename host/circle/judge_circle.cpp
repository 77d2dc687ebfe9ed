#include "host/circle/judge_circle.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>

#include "host/circle/rim/rim_model.h"
#include "host/circle/scene/cast_shadow.h"
#include "host/circle/settings/judgement.h"

namespace impactdic::circle {
namespace {

// Share of the circle that lies in the picture.
double share_in_view(const Frame& frame, const Circle& c) {
  constexpr int kPoints = 64;
  int inside = 0;
  for (int i = 0; i < kPoints; ++i) {
    const double angle = 2 * kPi * i / kPoints;
    const double x = c.cx_px + c.r_px * std::cos(angle), y = c.cy_px + c.r_px * std::sin(angle);
    inside += x >= 0 && y >= 0 && x <= frame.width() - 1 && y <= frame.height() - 1;
  }
  return static_cast<double>(std::max(inside, 1)) / kPoints;
}

}  // namespace

double rim_in_view(const CircleFit& fit, const Frame& frame) {
  return fit.rim_fraction / share_in_view(frame, fit.circle);
}

bool is_round(const CircleFit& fit) {
  return std::hypot(fit.e1_px, fit.e2_px) <= kTracking.found_oval * fit.circle.r_px;
}

bool is_flat(const RimModel* model) { return model && model->surface() == Surface::kFlat; }

bool is_plausible(const CircleFit& fit, const std::optional<double>& radius_px) {
  return fit.status == CircleStatus::kOk &&
         (!radius_px ||
          std::abs(fit.circle.r_px - *radius_px) < kTracking.radius_tolerance * *radius_px);
}

bool is_grown(const CircleFit& fit, const CirclePrior& prior) {
  const double last_px = prior.predicted.r_px + std::hypot(prior.e1_px, prior.e2_px);
  const double most_px = kTracking.most_growth * std::max(last_px, prior.radius_px.value_or(0));
  return fit.circle.r_px - kTracking.growth_sds * fit.r_sd_px > most_px;
}

bool stands_out(const CircleFit& fit, const Frame& frame, const std::optional<double>& radius_px) {
  const double rim = rim_in_view(fit, frame);
  if (rim >= kTracking.plain_rim) return true;
  const double r = fit.circle.r_px;
  return rim >= kTracking.found_rim && is_round(fit) &&
         (!radius_px || std::abs(r - *radius_px) <= kTracking.found_radius * *radius_px);
}

bool is_shadow_of(const Frame& frame, const Circle& ball, const CircleFit& found) {
  return found.status == CircleStatus::kOk && may_cast(ball, found.circle) &&
         is_flat_dark(frame, found.circle, &ball);
}

}  // namespace impactdic::circle
