#include "host/circle/sphere/disc_doubt.h"

#include <cmath>

#include "host/circle/rim/rim_model.h"
#include "host/circle/settings/sphere.h"

namespace impactdic::circle {

void widen(CircleFit& fit, double centre_px, double radius_px) {
  fit.cx_sd_px = std::hypot(fit.cx_sd_px, centre_px, fit.cx_with_r * radius_px);
  fit.cy_sd_px = std::hypot(fit.cy_sd_px, centre_px, fit.cy_with_r * radius_px);
  for (double* sd : {&fit.r_sd_px, &fit.shared_r_sd_px}) *sd = std::hypot(*sd, radius_px);
}

void doubt_disc(CircleFit& fit) {
  if (fit.status != CircleStatus::kOk) return;
  if (!fit.rim_model) {
    const bool doubted = fit.r_sd_px >= kSphere.crossings_radius_px || fit.by_hand != ByHand::kNo;
    if (!doubted) widen(fit, kSphere.crossings_centre_px, kSphere.crossings_radius_px);
  } else if (fit.rim_model->surface() == Surface::kFlat) {
    const double r = fit.circle.r_px;
    widen(fit, kSphere.disc_centre_sd_of_r * r, kSphere.radius_sd_of_r * r);
  }
}

}  // namespace impactdic::circle
