#include "host/circle/sphere/disc_doubt.h"

#include <cmath>

#include "host/circle/rim/rim_model.h"
#include "host/circle/settings/sphere.h"

namespace impactdic::circle {

void doubt_disc(CircleFit& fit) {
  if (fit.status != CircleStatus::kOk || !fit.rim_model ||
      fit.rim_model->surface() != Surface::kFlat) {
    return;
  }
  const double r = fit.circle.r_px;
  fit.cx_sd_px = std::hypot(fit.cx_sd_px, kSphere.disc_centre_sd_of_r * r);
  fit.cy_sd_px = std::hypot(fit.cy_sd_px, kSphere.disc_centre_sd_of_r * r);
  fit.r_sd_px = std::hypot(fit.r_sd_px, kSphere.radius_sd_of_r * r);
}

}  // namespace impactdic::circle
