#include "sim/contact/closed_form.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>

#include "sim/contact/impact.h"

namespace impactdic::sim::contact {

namespace {

double sign(double value) { return (value > 0) - (value < 0); }

// acos(zeta)/sqrt(1 - zeta^2), continued analytically through 1 to acosh(zeta)/sqrt(zeta^2 - 1).
double damped_angle(double zeta) {
  const double square = 1 - zeta * zeta;
  if (std::abs(square) < 1e-8) return 1 - (zeta - 1) / 3;  // series about 1
  return square > 0 ? std::acos(zeta) / std::sqrt(square) : std::acosh(zeta) / std::sqrt(-square);
}

double compression_damped_restitution(double zeta) { return std::exp(-zeta * damped_angle(zeta)); }

template <typename Function>
double solve(const Function& function, double low, double high) {
  boost::uintmax_t iterations = 200;
  const auto close = [](double a, double b) {
    return std::abs(b - a) <= 4e-16 * std::max(std::abs(a), std::abs(b));
  };
  const auto [a, b] = boost::math::tools::toms748_solve(function, low, high, close, iterations);
  return 0.5 * (a + b);
}

// At which damping in compression alone leaves this restitution, below 1.
double damping_ratio(double restitution) {
  double high = 1;
  while (compression_damped_restitution(high) > restitution) high *= 2;
  return solve([&](double z) { return compression_damped_restitution(z) - restitution; }, 0, high);
}

void require_shot(double restitution, double lowest, double contact_s) {
  if (!(restitution >= lowest && restitution <= 1 && restitution > 0)) {
    throw InvalidArgument("the restitution is out of range", "restitution");
  }
  if (!(contact_s > 0)) throw InvalidArgument("must be positive", "contact_s");
}

// After an impulse along the surface on a ball: R d(omega) = d(vt) / kappa.
ImpactVelocities with_tangential(const ImpactBody& ball, const ImpactVelocities& before,
                                 double restitution, double dvt) {
  return {before.vt_m_s + dvt, -restitution * before.vn_m_s,
          before.omega_rad_s + dvt / (ball.inertia_factor() * ball.radius_m())};
}

double tip_velocity(const ImpactBody& ball, const ImpactVelocities& v) {
  return v.vt_m_s + ball.radius_m() * v.omega_rad_s;
}

}  // namespace

ImpactVelocities cross_rebound(const ImpactBody& ball, const ImpactVelocities& before,
                               double restitution, double tangential_restitution) {
  const double kappa = ball.inertia_factor();
  const double dvt =
      -(1 + tangential_restitution) * tip_velocity(ball, before) * kappa / (1 + kappa);
  return with_tangential(ball, before, restitution, dvt);
}

ImpactVelocities garwin_rebound(const ImpactBody& ball, const ImpactVelocities& before) {
  return cross_rebound(ball, before, 1, 1);
}

ImpactVelocities walton_rebound(const ImpactBody& ball, const ImpactVelocities& before,
                                double restitution, double friction,
                                double tangential_restitution) {
  const double kappa = ball.inertia_factor(), tip = tip_velocity(ball, before);
  const double sliding = friction * (1 + restitution) * std::abs(before.vn_m_s);
  const double sticking = (1 + tangential_restitution) * std::abs(tip) * kappa / (1 + kappa);
  return with_tangential(ball, before, restitution, -sign(tip) * std::min(sliding, sticking));
}

ImpactVelocities brody_rebound(const ImpactBody& ball, const ImpactVelocities& before,
                               double restitution, double friction) {
  return walton_rebound(ball, before, restitution, friction, 0);
}

LinearImpact linear_impact(double mass_kg, double stiffness_n_per_m, double damping_n_s_per_m,
                           double speed_m_s) {
  const double omega0 = std::sqrt(stiffness_n_per_m / mass_kg);
  const double zeta = damping_n_s_per_m / (2 * std::sqrt(stiffness_n_per_m * mass_kg));
  LinearImpact impact;
  impact.t_max_compression_s = damped_angle(zeta) / omega0;
  impact.restitution = compression_damped_restitution(zeta);
  impact.contact_s = impact.t_max_compression_s + kPi / (2 * omega0);
  impact.max_deflection_m = impact.restitution * speed_m_s / omega0;
  return impact;
}

double damped_restitution(double damping_ratio, RestitutionDamping damping) {
  switch (damping) {
    case RestitutionDamping::kNone:
      return compression_damped_restitution(damping_ratio);
    case RestitutionDamping::kToZeroForce:
      return std::exp(-2 * damping_ratio * damped_angle(damping_ratio));
    case RestitutionDamping::kToZeroDeflection:
      break;
  }
  if (!(damping_ratio < 1)) {
    throw InvalidArgument("an overdamped contact never returns to zero deflection",
                          "damping ratio");
  }
  return std::exp(-kPi * damping_ratio / std::sqrt(1 - damping_ratio * damping_ratio));
}

SpringDamperParameters linear_parameters(double mass_kg, double restitution, double contact_s) {
  require_shot(restitution, 0, contact_s);
  const double zeta = restitution < 1 ? damping_ratio(restitution) : 0;
  const double omega0 = (damped_angle(zeta) + kPi / 2) / contact_s;
  const double stiffness = mass_kg * omega0 * omega0;
  return {stiffness, 2 * zeta * std::sqrt(stiffness * mass_kg)};
}

SpringDamperParameters kelvin_voigt_parameters(double mass_kg, double restitution,
                                               double contact_s) {
  require_shot(restitution, 0, contact_s);
  const double decay = std::log(restitution);
  return {mass_kg * (kPi * kPi + decay * decay) / (contact_s * contact_s),
          -2 * mass_kg / contact_s * decay};
}

SpringDamperParameters force_free_parameters(double mass_kg, double restitution, double contact_s) {
  require_shot(restitution, 0, contact_s);
  // e is the square of what damping in compression alone leaves.
  const double zeta = restitution < 1 ? damping_ratio(std::sqrt(restitution)) : 0;
  const double omega0 = 2 * damped_angle(zeta) / contact_s;
  const double stiffness = mass_kg * omega0 * omega0;
  return {stiffness, 2 * zeta * std::sqrt(stiffness * mass_kg)};
}

SpringDamperParameters hertz_parameters(double mass_kg, double speed_m_s, double restitution,
                                        double contact_s, RestitutionDamping damping) {
  require_shot(restitution, 0.05, contact_s);
  ImpactJob job;  // unit mass, stiffness and speed: damping and time are then dimensionless
  job.normal = NormalModel::kHertzDamper;
  job.friction = FrictionModel::kNone;
  job.body = {BodyShape::kSolidSphere, 1, 1};
  job.contact.stiffness = 1;
  job.contact.restitution_damping = damping;
  job.initial.vn_m_s = -1;
  job.gravity_m_s2 = 0;
  const auto impact = [&job](double b) {
    job.contact.damping_n_s_per_m = b;
    return simulate_impact(job);
  };
  double scaled = 0;
  if (restitution < 1) {
    double high = 1;
    while (impact(high).restitution > restitution) high *= 2;
    scaled = solve([&](double b) { return impact(b).restitution - restitution; }, 0, high);
  }
  const double time = impact(scaled).contact_s;  // T (k/m)^.4 v^.2
  const double stiffness = mass_kg * std::pow(time / (contact_s * std::pow(speed_m_s, 0.2)), 2.5);
  return {stiffness,
          scaled * std::pow(mass_kg, 0.6) * std::pow(stiffness, 0.4) * std::pow(speed_m_s, 0.2)};
}

double hertz_max_deflection_m(double mass_kg, double stiffness_n_per_m1p5, double speed_m_s) {
  return std::pow(1.25 * mass_kg * speed_m_s * speed_m_s / stiffness_n_per_m1p5, 0.4);
}

double hertz_contact_s(double mass_kg, double stiffness_n_per_m1p5, double speed_m_s) {
  const double factor = 0.8 * std::sqrt(kPi) * boost::math::tgamma(0.4) / boost::math::tgamma(0.9);
  return factor * hertz_max_deflection_m(mass_kg, stiffness_n_per_m1p5, speed_m_s) / speed_m_s;
}

double maw_psi(double poisson, double friction, double tip_vt_m_s, double speed_n_m_s) {
  return 2 * (1 - poisson) / (friction * (2 - poisson)) * tip_vt_m_s / speed_n_m_s;
}

double maw_chi(double poisson, double inertia_factor) {
  return (1 - poisson) * (1 + 1 / inertia_factor) / (2 - poisson);
}

}  // namespace impactdic::sim::contact
