#include "sim/fit/restitution_duration.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>

#include "host/base/parse.h"
#include "sim/contact/impact.h"

namespace impactdic::sim::fit {
namespace {

struct Outcome {
  double log_restitution, log_duration;
};

Outcome outcome(ImpactJob& job, double stiffness, double damping) {
  job.contact.stiffness = stiffness;
  job.contact.set_damping(job.normal, damping);
  const ImpactResult impact = contact::simulate_impact(job);
  return {std::log(std::max(impact.restitution, 1e-12)), std::log(impact.contact_s)};
}

// The law's own damping constant that gives one N s/m at this depth.
double damping_unit_at(const ImpactJob& job, double stiffness, double depth_m) {
  const double root = std::sqrt(depth_m);
  switch (job.normal) {
    case NormalModel::kTsuji:
      return 1 / (std::sqrt(job.body.mass_kg * stiffness) * std::sqrt(root));
    case NormalModel::kKuwabaraKono:
      return 1 / (1.5 * stiffness * root);
    case NormalModel::kHuntCrossley:
      return 1 / (1.5 * stiffness * depth_m * root);
    default:
      return 1;
  }
}

struct Start {
  contact::SpringDamperParameters pair;
  double damping_step = 0;  // small against what damps critically
};

// A start: the linear pair, and for Hertz the linear spring's force at the same deepest point.
Start start(const ImpactJob& job, double restitution, double duration_s) {
  contact::SpringDamperParameters pair =
      contact::linear_parameters(job.body.mass_kg, restitution, duration_s);
  const double speed = std::abs(job.initial.vn_m_s);
  const double depth = speed * std::sqrt(job.body.mass_kg / pair.stiffness);
  if (has_hertz_spring(job.normal)) pair.stiffness /= std::sqrt(depth);
  const double unit = damping_unit_at(job, pair.stiffness, depth);
  pair.damping_n_s_per_m *= unit;
  return {pair, std::sqrt(job.body.mass_kg * pair.stiffness) * 1e-4 * unit};
}

}  // namespace

contact::SpringDamperParameters spring_and_damper(ImpactJob job, double restitution,
                                                  double duration_s) {
  if (damping_key(job.normal).empty()) {
    throw InvalidArgument("restitution_duration needs a law with stiffness and damping", "normal",
                          "linear_spring_damper, hertz_damper, tsuji, kuwabara_kono or "
                          "hunt_crossley");
  }
  // The normal motion alone decides: no friction, no spin.
  job.friction = FrictionModel::kNone;
  auto [pair, damping_unit] = start(job, restitution, duration_s);
  const double target_e = std::log(restitution), target_t = std::log(duration_s);
  // Newton in (ln k, b) with a Jacobian by differences; damping never below zero.
  for (int i = 0; i < 60; ++i) {
    const Outcome here = outcome(job, pair.stiffness, pair.damping_n_s_per_m);
    const double miss_e = target_e - here.log_restitution, miss_t = target_t - here.log_duration;
    if (std::abs(miss_e) < 1e-11 && std::abs(miss_t) < 1e-11) return pair;
    constexpr double kStep = 1e-5;
    const double step_b = std::max(damping_unit, 1e-5 * pair.damping_n_s_per_m);
    const Outcome stiffer = outcome(job, pair.stiffness * std::exp(kStep), pair.damping_n_s_per_m);
    const Outcome damped = outcome(job, pair.stiffness, pair.damping_n_s_per_m + step_b);
    const double e_k = (stiffer.log_restitution - here.log_restitution) / kStep;
    const double t_k = (stiffer.log_duration - here.log_duration) / kStep;
    const double e_b = (damped.log_restitution - here.log_restitution) / step_b;
    const double t_b = (damped.log_duration - here.log_duration) / step_b;
    const double det = e_k * t_b - e_b * t_k;
    const double dk = std::clamp((miss_e * t_b - e_b * miss_t) / det, -1.0, 1.0);
    const double db = (e_k * miss_t - t_k * miss_e) / det;
    pair.stiffness *= std::exp(dk);
    const double before = pair.damping_n_s_per_m;
    pair.damping_n_s_per_m = std::max(before + db, before / 10);
    if (std::abs(dk) < 1e-12 && std::abs(db) < 1e-12 * damping_unit) return pair;
    // Differences limit the last digits; there the figures are met as well as they can be.
    if (i > 20 && std::abs(miss_e) < 1e-8 && std::abs(miss_t) < 1e-8) return pair;
  }
  throw InvalidArgument("no stiffness and damping give a restitution of " + shortest(restitution) +
                            " in " + shortest(duration_s) + " s",
                        "restitution_duration");
}

ContactTiming timing_from_crossing(const ImpactJob& job, double restitution,
                                   double crossing_above_lowest_m, double start_s) {
  ImpactJob trial = job;
  trial.friction = FrictionModel::kNone;
  const double gravity = job.gravity_m_s2 * std::cos(job.surface_angle_deg * kRadPerDeg);
  double duration = start_s;
  for (int i = 0; i < 50; ++i) {
    const contact::SpringDamperParameters pair = spring_and_damper(trial, restitution, duration);
    trial.contact.stiffness = pair.stiffness;
    trial.contact.set_damping(trial.normal, pair.damping_n_s_per_m);
    const ImpactResult impact = contact::simulate_impact(trial);
    // Both flights with the fall taken out are straight lines.
    const double end = impact.contact_s;
    const double in = job.initial.vn_m_s, out = impact.final.vn_m_s + gravity * end;
    const double at_end = impact.final.qn_m + gravity * end * end / 2;
    const double cross = (at_end - out * end) / (in - out);
    const double height = in * cross - gravity * cross * cross / 2 + impact.max_deflection_m;
    const double factor = std::clamp(crossing_above_lowest_m / height, 0.5, 2.0);
    duration *= factor;
    if (std::abs(factor - 1) < 1e-10) return {duration, cross};
  }
  throw InvalidArgument("no duration of the contact fits the path's lowest point",
                        "restitution_duration");
}

}  // namespace impactdic::sim::fit
