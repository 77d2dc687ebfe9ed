// The orientation of a ball along its path.
#pragma once

#include <impactdic/impact_model.h>

#include <Eigen/Geometry>

#include "sim/contact/contact_dynamics.h"

namespace impactdic::sim::contact {

// Since its start, in local axes (t, n, b). The turn over a step is the exponential of Magnus'
// series (1954) to the fourth order: the integral of the spin, which the motion of the centre gives
// exactly, and the part by which turns about different axes do not commute.
class OrientationPath {
 public:
  explicit OrientationPath(const ImpactBody& body)
      : spin_per_push_(-body.mass_kg * body.radius_m() / body.inertia()) {}

  void start(double time_s, const ImpactState& x) { time_s_ = time_s, x_ = x; }
  void reach(double time_s, const ImpactState& x) {
    // A turn in the plane adds up by itself.
    if (in_plane(x_) && in_plane(x)) return;
    turned_ = at(time_s, x);
    start(time_s, x);
  }
  // Near the instant that was reached last: after it, or before the path's start.
  Eigen::Quaterniond at(double time_s, const ImpactState& x) const {
    const double h = time_s - time_s_;
    // Friction that pushes the centre across by dv turns the ball about t by -m R/I dv.
    const double push = x[kQb] - x_[kQb] - x_[kVb] * h;
    const Eigen::Vector3d integral(x_[kOmegaT] * h + spin_per_push_ * push, x_[kOmegaN] * h,
                                   x[kAngle] - x_[kAngle]);
    const Eigen::Vector3d turn = integral + h * h / 12 * spin(x).cross(spin(x_));
    const double angle = turn.norm();
    if (angle == 0) return turned_;
    return (Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) * turned_).normalized();
  }

 private:
  static bool in_plane(const ImpactState& x) {
    return x[kOmegaT] == 0 && x[kOmegaN] == 0 && x[kQb] == 0 && x[kVb] == 0;
  }
  static Eigen::Vector3d spin(const ImpactState& x) { return {x[kOmegaT], x[kOmegaN], x[kOmega]}; }

  double spin_per_push_;
  double time_s_ = 0;
  ImpactState x_{};
  Eigen::Quaterniond turned_ = Eigen::Quaterniond::Identity();
};

}  // namespace impactdic::sim::contact
