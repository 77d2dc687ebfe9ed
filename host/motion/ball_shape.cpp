#include "host/motion/ball_shape.h"

#include <cmath>

namespace impactdic::motion {

bool BallShape::is_compressed() const {
  constexpr double kCompressed = 0.01;
  return std::hypot(e1, e2) > kCompressed;
}

BallShape shape_of(const circle::CircleFit& fit) {
  const double r = fit.circle.r_px;
  if (!(r > 0)) return {};
  // The wave of an ellipse around a rim is known to √2 of what the mean is known to. A ball that is
  // pressed along one axis is smaller by as much as its ellipse is long.
  const double hidden = std::sqrt(2) * fit.own_r_sd_px / r;
  if (!fit.ellipse) return {0, 0, hidden, hidden};
  return {fit.e1_px / r, fit.e2_px / r, std::hypot(fit.e1_sd_px, fit.e2_sd_px) / std::sqrt(2) / r,
          fit.r_sd_px / r};
}

Gradient gradient_of(const Stretch& stretch, double rot_rad) {
  const double c = std::cos(rot_rad), s = std::sin(rot_rad);
  const double xx = 1 + stretch.xx, xy = stretch.xy, yy = 1 + stretch.yy;
  return {c * xx + s * xy, c * xy + s * yy, c * xy - s * xx, c * yy - s * xy};
}

Gradient inverse(const Gradient& g) {
  const double det = g.xx * g.yy - g.xy * g.yx;
  return {g.yy / det, -g.xy / det, -g.yx / det, g.xx / det};
}

BallShape shape_before(const BallShape& second, const BallMotion& strain) {
  // The second shape in the first frame's axes, where the ball has turned back.
  const double c = std::cos(2.0 * strain.rot_rad), s = std::sin(2.0 * strain.rot_rad);
  const double by_strain = std::hypot(strain.exx_sd, strain.eyy_sd, 2 * strain.exy_sd) / 2;
  return {second.e1 * c - second.e2 * s - (strain.exx - strain.eyy) / 2.0,
          second.e1 * s + second.e2 * c - strain.exy, std::hypot(second.sd, by_strain)};
}

void correct_turn(const BallShape& first, const BallMotion& strain, dic::RigidMotion& motion) {
  if (!first.is_compressed()) return;
  // The gradient is Q U with the rotation Q and U = 1 + strain, so the turn of U V1 is missing.
  const double differ = strain.exx - strain.eyy, skew = strain.exy;
  const double across = first.e2 * differ - 2 * first.e1 * skew;
  const double along = 2.0 + strain.exx + strain.eyy + first.e1 * differ + 2 * first.e2 * skew;
  motion.rot_rad += std::atan2(across, along);
  const double by_shape = std::hypot(differ, 2 * skew) * first.sd;
  const double by_strain =
      std::hypot(first.e2 * strain.exx_sd, first.e2 * strain.eyy_sd, 2 * first.e1 * strain.exy_sd);
  motion.rot_sd_rad = std::hypot(motion.rot_sd_rad, by_shape / along, by_strain / along);
}

}  // namespace impactdic::motion
