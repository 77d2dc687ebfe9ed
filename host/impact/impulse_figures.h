// The figures of an impact from the velocities before and after it, each formula once. Any unit of
// length and time that all of a call share. Axes: t along the surface, n out of it; rotation
// counter-clockwise. Internal.
#pragma once

namespace impactdic::impact {

// Newton's restitution.
inline double restitution(double vn_before, double vn_after) { return -vn_after / vn_before; }

// Velocity along the surface of the point where a ball touches it.
inline double tip_velocity(double vt, double omega, double radius) { return vt + radius * omega; }

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

// Inertia factor I / (m R^2) for which the tangential impulse explains the change of spin.
inline double closing_inertia(double impulse_t, double radius, double change_of_spin) {
  return impulse_t / (radius * change_of_spin);
}

}  // namespace impactdic::impact
