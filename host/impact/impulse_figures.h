// The figures of an impact from the velocities before and after it, each formula once. Any unit of
// length and time that all of a call share. Axes: t along the surface, n out of it, b = t x n;
// rotation about b, counter-clockwise. Internal.
#pragma once

#include <cmath>

namespace impactdic::impact {

// A vector in the surface.
struct Tangential {
  double t = 0, b = 0;
};
inline double along(const Tangential& direction, const Tangential& v) {
  return direction.t * v.t + direction.b * v.b;
}

// Newton's restitution.
inline double restitution(double vn_before, double vn_after) { return -vn_after / vn_before; }

// Velocity along the surface of the point where a ball touches it.
inline double tip_velocity(double vt, double omega, double radius) { return vt + radius * omega; }

// The same as a vector, with the spin about t: omega x (-R n).
inline Tangential tip_velocity(const Tangential& v, double omega_b, double omega_t, double radius) {
  return {tip_velocity(v.t, omega_b, radius), v.b - radius * omega_t};
}

// Where the contact point slips to. In plane motion exactly along t; of a contact point at rest
// against t, so that an impulse along t counts as positive.
inline Tangential slip_direction(const Tangential& tip) {
  if (tip.b == 0) return {tip.t > 0 ? 1.0 : -1.0, 0};
  const double speed = std::hypot(tip.t, tip.b);
  return {tip.t / speed, tip.b / speed};
}

// What the surface does to one component of the velocity: `by_gravity` is gravity's part.
inline double surface_impulse(double before, double after, double by_gravity = 0) {
  return after - before - by_gravity;
}

// The sign that makes a tangential impulse positive where it opposes the slip.
inline double against_slip(double tip) { return tip > 0 ? -1 : 1; }

// Effective friction, an impulse ratio (the dissertation's Eq. 3.12, which leaves gravity's impulse
// in both): no more than the coefficient of friction, less where the ball stops slipping.
inline double impulse_ratio(double impulse_t, double impulse_n) { return impulse_t / impulse_n; }

// The impulse ratio that stops the tip, so that the ball rolls, and turns it round as far as it
// does: (1 + e_t)|vt + R omega| / [(1 + 1/kappa)(1 + e)|vn|] before, where (1 + e)|vn| = change_n
// for any e, and e_t >= 0 is the tip's velocity after over before, sign turned. Without e_t a
// surface that springs back along itself exceeds it.
inline double rolling_cap(double tip_before, double tip_after, double inertia_factor,
                          double change_n) {
  const double stopped = tip_before > 0 ? tip_before : -tip_before;
  const double reversed = tip_before > 0 ? -tip_after : tip_after;
  return (stopped + (reversed > 0 ? reversed : 0)) / ((1 + 1 / inertia_factor) * change_n);
}

inline double rolling_cap(const Tangential& tip_before, const Tangential& tip_after,
                          double inertia_factor, double change_n) {
  if (tip_before.b == 0) return rolling_cap(tip_before.t, tip_after.t, inertia_factor, change_n);
  const Tangential slip = slip_direction(tip_before);
  return rolling_cap(along(slip, tip_before), along(slip, tip_after), inertia_factor, change_n);
}

// Inertia factor I / (m R^2) for which the tangential impulse explains the change of spin.
inline double closing_inertia(double impulse_t, double radius, double change_of_spin) {
  return impulse_t / (radius * change_of_spin);
}

}  // namespace impactdic::impact
