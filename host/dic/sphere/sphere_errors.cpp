#include "host/dic/sphere/sphere_errors.h"

#include <array>
#include <cmath>

#include "host/sphere/source_response.h"

namespace impactdic::dic {

void add_source_errors(RigidMotion& motion, const SphereSource& source) {
  const auto response =
      sphere::source_response({{motion.rot_x_rad, motion.rot_y_rad, motion.rot_rad},
                               source.radius_px,
                               source.aside_px,
                               source.later_aside_px,
                               source.light});
  if (!std::isfinite(response.rot_z[sphere::kToRadius])) return;
  const std::array<double, 4> sd = {source.cx_sd_px, source.cy_sd_px, source.radius_sd_px,
                                    source.nearness_sd};
  const auto shared_by = [&](const auto& a, const auto& b) {
    double covariance = 0;
    for (std::size_t k = 0; k < sd.size(); ++k) covariance += a[k] * b[k] * sd[k] * sd[k];
    return covariance;
  };
  const auto widen = [&](double& shift_sd, double& turn_sd, double& correlation, const auto& shift,
                         const auto& turn) {
    const double shared = correlation * shift_sd * turn_sd + shared_by(shift, turn);
    shift_sd = std::hypot(shift_sd, std::sqrt(shared_by(shift, shift)));
    turn_sd = std::hypot(turn_sd, std::sqrt(shared_by(turn, turn)));
    correlation = shared / (shift_sd * turn_sd);
  };
  widen(motion.dx_sd_px, motion.rot_y_sd_rad, motion.dx_rot_y_corr, response.dx, response.rot_y);
  widen(motion.dy_sd_px, motion.rot_x_sd_rad, motion.dy_rot_x_corr, response.dy, response.rot_x);
  motion.rot_sd_rad =
      std::hypot(motion.rot_sd_rad, std::sqrt(shared_by(response.rot_z, response.rot_z)));
}

}  // namespace impactdic::dic
