// Partial slip by following many springs one by one: an independent reference for
// maw_barber_fawcett. Each spring is pressed, dragged along and clipped to Coulomb's limit in turn;
// a damper that pushes adds its friction where springs slip, one that pulls takes load off them.
#pragma once

#include <impactdic/impact_model.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace impactdic::support {

struct SpringsOutcome {
  double vt_m_s = 0, vn_m_s = 0, omega_rad_s = 0;
};

// Velocity Verlet with `steps` steps per duration of the undamped contact.
inline SpringsOutcome discrete_springs(const ImpactJob& job, int springs, int steps) {
  const double m = job.body.mass_kg, radius = job.body.radius_m(), inertia = job.body.inertia();
  const double k = job.contact.stiffness, b = job.contact.damping_n_s_per_m;
  const double mu = job.contact.friction_kinetic, nu = job.contact.poisson;
  const double ratio = 2 * (1 - nu) / (2 - nu), modulus = 0.75 * k / std::sqrt(radius);
  const double alpha = mu / ratio, slope = job.surface_angle_deg * 3.14159265358979323846 / 180;
  const double gt = -job.gravity_m_s2 * std::sin(slope), gn = -job.gravity_m_s2 * std::cos(slope);
  const double speed = -job.initial.vn_m_s;
  const bool damped = job.contact.restitution_damping != RestitutionDamping::kNone;
  const double undamped = std::pow(1.25 * m * speed * speed / k, 0.4);
  const double depth = 1.02 * undamped + std::abs(gn) * m / k / std::sqrt(undamped);
  const double dx = std::sqrt(radius * depth) / springs, dt = 2.94328 * undamped / speed / steps;
  std::vector<double> u(springs, 0.0), pressed(springs);
  for (int i = 0; i < springs; ++i) pressed[i] = std::pow((i + 0.5) * dx, 2) / radius;
  double delta = 0, rate = speed, vt = job.initial.vt_m_s, omega = job.initial.omega_rad_s;
  double tangential = 0;
  bool compressing = true;
  const auto spring_force = [&] { return k * std::pow(std::max(delta, 0.0), 1.5); };
  const auto normal = [&] { return spring_force() + (compressing || damped ? b * rate : 0.0); };
  const double first_slip = vt + radius * omega;
  tangential = -mu * b * speed *
               (std::abs(first_slip) > alpha * speed ? (first_slip > 0) - (first_slip < 0) : 0);
  for (int step = 0; step < 60 * steps; ++step) {
    rate -= 0.5 * dt * (normal() / m + gn);
    vt += 0.5 * dt * (tangential / m + gt);
    omega += 0.5 * dt * radius * tangential / inertia;
    delta += dt * rate;
    if (rate < 0) compressing = false;
    const double way = dt * (vt + radius * omega);
    const double load = normal();
    if (!compressing && load <= 0) break;
    const double reach = compressing || !damped || b == 0 ? delta : std::pow(load / k, 2.0 / 3.0);
    double sum = 0, slipping = 0, all = 0;
    for (int i = 0; i < springs; ++i) {
      const double uz = reach - pressed[i];
      if (uz <= 0) {
        u[i] = 0;
        continue;
      }
      const double moved = u[i] + way, bound = alpha * uz;
      u[i] = std::clamp(moved, -bound, bound);
      sum += u[i];
      all += uz;
      if (moved > bound) slipping += uz;
      if (moved < -bound) slipping -= uz;
    }
    tangential = -2 * ratio * modulus * sum * dx;
    if (compressing && all > 0) tangential -= mu * b * rate * slipping / all;
    rate -= 0.5 * dt * (normal() / m + gn);
    vt += 0.5 * dt * (tangential / m + gt);
    omega += 0.5 * dt * radius * tangential / inertia;
    if (!compressing && delta <= 0) break;
  }
  return {vt, -rate, omega};
}

// The velocity of the contact point along the surface after the impact.
inline double discrete_springs_tip(const ImpactJob& job, int springs, int steps) {
  const SpringsOutcome s = discrete_springs(job, springs, steps);
  return s.vt_m_s + job.body.radius_m() * s.omega_rad_s;
}

}  // namespace impactdic::support
