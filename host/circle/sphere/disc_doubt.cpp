#include "host/circle/sphere/disc_doubt.h"

#include <cmath>

#include "host/circle/rim/rim_model.h"
#include "host/circle/settings/judgement.h"
#include "host/circle/settings/sphere.h"

namespace impactdic::circle {

void widen(CircleFit& fit, double centre_px, double radius_px) {
  fit.cx_sd_px = std::hypot(fit.cx_sd_px, centre_px, fit.cx_with_r * radius_px);
  fit.cy_sd_px = std::hypot(fit.cy_sd_px, centre_px, fit.cy_with_r * radius_px);
  for (double* sd : {&fit.r_sd_px, &fit.shared_r_sd_px}) *sd = std::hypot(*sd, radius_px);
}

bool is_cut(const CircleFit& fit) {
  return std::hypot(fit.cx_with_r, fit.cy_with_r) > kJudge.cut_with_r;
}

void doubt_disc(CircleFit& fit) {
  if (fit.status != CircleStatus::kOk || fit.by_hand != ByHand::kNo) return;
  if (fit.rim_model && fit.rim_model->surface() != Surface::kFlat) return;
  const double r = fit.circle.r_px;
  if (fit.rim_model) {
    widen(fit, kSphere.disc_centre_sd_of_r * r, kSphere.radius_sd_of_r * r);
  } else if (fit.r_sd_px < kSphere.crossings_radius_px) {
    widen(fit, kSphere.crossings_centre_px, kSphere.crossings_radius_px);
  }
  if (is_cut(fit)) widen(fit, 0, kSphere.lit_arc_of_r * r);
}

}  // namespace impactdic::circle
