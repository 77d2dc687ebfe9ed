#include "host/circle/rim_in_view.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>

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

bool stands_out(const CircleFit& fit, const Frame& frame, const std::optional<double>& radius_px) {
  const double rim = rim_in_view(fit, frame);
  if (rim >= kTracking.plain_rim) return true;
  const double r = fit.circle.r_px;
  return rim >= kTracking.found_rim && is_round(fit) &&
         (!radius_px || std::abs(r - *radius_px) <= kTracking.found_radius * *radius_px);
}

}  // namespace impactdic::circle
