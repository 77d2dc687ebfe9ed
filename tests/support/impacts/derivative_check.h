// The derivatives of an impact against differences of impacts.
#pragma once

#include <impactdic/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "sim/contact/derivatives/derivatives.h"
#include "sim/contact/impact.h"
#include "sim/contact/numbers/numbers.h"

namespace impactdic::support {

// The number of a job by its key.
inline double& number_of(ImpactJob& job, const std::string& key) {
  const auto body = [](ImpactBody& b, const std::string& part) -> double& {
    if (part == "mass_kg") return b.mass_kg;
    if (part == "diameter_m") return b.diameter_m;
    return part == "length_m" ? b.length_m : b.inertia_kg_m2;
  };
  const auto motion = [](InitialMotion& m, const std::string& part) -> double* {
    const std::map<std::string, double*> parts{{"vt_m_s", &m.vt_m_s},
                                               {"vn_m_s", &m.vn_m_s},
                                               {"vb_m_s", &m.vb_m_s},
                                               {"omega_rad_s", &m.omega_rad_s},
                                               {"omega_t_rad_s", &m.omega_t_rad_s},
                                               {"omega_n_rad_s", &m.omega_n_rad_s},
                                               {"gap_m", &m.gap_m},
                                               {"angle_deg", &m.angle_deg}};
    const auto found = parts.find(part);
    return found == parts.end() ? nullptr : found->second;
  };
  const std::string table = key.substr(0, key.find('.')), part = key.substr(key.find('.') + 1);
  if (table == "body") return body(job.body, part);
  if (table == "initial") return *motion(job.initial, part);
  if (table == "other") {
    double* moves = motion(job.other->initial, part);
    return moves != nullptr ? *moves : body(job.other->body, part);
  }
  if (table == "surface") return part == "radius_m" ? job.surface_radius_m : job.surface_angle_deg;
  if (table == "environment") return job.gravity_m_s2;
  if (table == "shell") {
    if (part == "stiffness_n_per_m") return job.shell->stiffness_n_per_m;
    return part == "flat_fraction" ? job.shell->flat_fraction : job.shell->damping_n_s_per_m;
  }
  if (part == "drag_coefficient") return job.air.drag_coefficient;
  if (part == "lift_coefficient") return job.air.lift_coefficient;
  if (part == "density_kg_m3") return job.air.density_kg_m3;
  ContactParameters& c = job.contact;
  if (part == stiffness_key(job.normal)) return c.stiffness;
  const std::map<std::string, double*> parts{
      {"damping_n_s_per_m", &c.damping_n_s_per_m},
      {"damping_factor", &c.damping_factor},
      {"dissipation_s", &c.dissipation_s},
      {"damping_s_per_m", &c.damping_s_per_m},
      {"friction_kinetic", &c.friction_kinetic},
      {"friction_static", &c.friction_static},
      {"friction_speed_m_s", &c.friction_speed_m_s},
      {"rolling_friction", &c.rolling_friction},
      {"spinning_friction", &c.spinning_friction},
      {"poisson", &c.poisson},
      {"reduced_modulus_pa", &c.reduced_modulus_pa},
      {"yield_strength_pa", &c.yield_strength_pa},
      {"adhesion_j_m2", &c.adhesion_j_per_m2},
      {"unloading_stiffness_n_per_m", &c.unloading_stiffness_n_per_m},
      {"unloading_hardening_per_m", &c.unloading_hardening_per_m},
      {"tangential_stiffness_n_per_m", &c.tangential_stiffness_n_per_m}};
  return *parts.at(part);
}

// What an outcome is measured by: each of them over these.
struct OutcomeScales {
  double speed, spin, time, depth, force;
};

inline std::map<std::string, double> outcomes_of(const ImpactResult& r, const OutcomeScales& s) {
  std::map<std::string, double> list{{"restitution", r.restitution},
                                     {"contact_s", r.contact_s / s.time},
                                     {"t_max_compression_s", r.t_max_compression_s / s.time},
                                     {"max_deflection_m", r.max_deflection_m / s.depth},
                                     {"max_force_n", r.max_force_n / s.force},
                                     {"end_s", r.end_s / s.time},
                                     {"tip_vt_final_m_s", r.tip_vt_final_m_s / s.speed},
                                     {"tip_vb_final_m_s", r.tip_vb_final_m_s / s.speed}};
  const auto add = [&](const std::string& of, const BodyState& x) {
    list[of + ".vt_m_s"] = x.vt_m_s / s.speed;
    list[of + ".vn_m_s"] = x.vn_m_s / s.speed;
    list[of + ".vb_m_s"] = x.vb_m_s / s.speed;
    list[of + ".omega_rad_s"] = x.omega_rad_s / s.spin;
    list[of + ".omega_t_rad_s"] = x.omega_t_rad_s / s.spin;
    list[of + ".qt_m"] = x.qt_m / (s.speed * s.time);
    list[of + ".qn_m"] = x.qn_m / (s.speed * s.time);
    list[of + ".qb_m"] = x.qb_m / (s.speed * s.time);
    list[of + ".angle_rad"] = x.angle_rad / (s.spin * s.time);
  };
  add("final", r.final);
  return list;
}

struct DerivativeError {
  double worst = 0;    // of all outcomes by all inputs, in parts of their scales
  std::string where;   // that it belongs to
  int compared = 0;    // how many derivatives
  int undecided = 0;   // where the differences do not converge: a fork is near
  int missing = 0;     // where none is told, but the differences converge
  double largest = 0;  // derivative
};

inline double scale_of(const std::string& outcome, const OutcomeScales& s) {
  const auto has = [&](const char* part) { return outcome.find(part) != std::string::npos; };
  if (has("omega")) return s.spin;
  if (has("angle")) return s.spin * s.time;
  if (has("force")) return s.force;
  if (outcome == "max_deflection_m") return s.depth;
  if (has(".q")) return s.speed * s.time;
  if (has("_m_s")) return s.speed;
  return outcome == "restitution" ? 1 : s.time;
}

// Central differences of all outcomes by one input, per part of its scale, each step half the last.
using Differences = std::array<std::map<std::string, double>, 5>;
inline std::optional<Differences> differences(const ImpactJob& job, const std::string& key,
                                              double input_scale, const OutcomeScales& scales) {
  double part = 2e-3;
  Differences table;
  try {
    for (auto& row : table) {
      ImpactJob high = job, low = job;
      number_of(high, key) += part * input_scale;
      number_of(low, key) -= part * input_scale;
      const auto up = outcomes_of(sim::contact::simulate_impact(high), scales);
      const auto down = outcomes_of(sim::contact::simulate_impact(low), scales);
      for (const auto& [name, value] : up) row[name] = (value - down.at(name)) / (2 * part);
      part /= 2;
    }
  } catch (const Error&) {
    return std::nullopt;
  }
  return table;
}

// The extrapolation to no step that moves least (Ridders 1982), and by how much it moves.
inline std::pair<double, double> extrapolated(const Differences& table, const std::string& name) {
  std::array<std::array<double, std::tuple_size_v<Differences>>, std::tuple_size_v<Differences>>
      t{};
  double best = 0, moved = 1e300;
  for (std::size_t i = 0; i < t.size(); ++i) {
    t[i][0] = table[i].at(name);
    double four = 4;
    for (std::size_t k = 1; k <= i; ++k, four *= 4) {
      t[i][k] = t[i][k - 1] + (t[i][k - 1] - t[i - 1][k - 1]) / (four - 1);
      const double moves =
          std::max(std::abs(t[i][k] - t[i][k - 1]), std::abs(t[i][k] - t[i - 1][k - 1]));
      if (moves < moved) moved = moves, best = t[i][k];
    }
  }
  return {best, moved};
}

inline void compare(DerivativeError& error, const std::string& name, double told, double best) {
  if (std::isnan(told)) {
    ++error.missing;
    return;
  }
  ++error.compared;
  error.largest = std::max(error.largest, std::abs(best));
  const double off = std::abs(told - best) / std::max(1.0, std::abs(best));
  if (off > error.worst) error.worst = off, error.where = name;
}

inline std::size_t place_of(const std::vector<std::string>& list, const std::string& name) {
  return static_cast<std::size_t>(std::find(list.begin(), list.end(), name) - list.begin());
}

// `converged`: by how much the last extrapolation may move. Of the inputs every `stride`-th, from
// `first` on; not those at the end of their range, of which no central difference can be taken.
inline DerivativeError derivative_error(ImpactJob job, double converged, std::size_t first = 0,
                                        std::size_t stride = 1) {
  job.solver.relative_tolerance = 1e-13;
  const ImpactResult plain = sim::contact::simulate_impact(job);
  ImpactJob asked = job;
  asked.solver.relative_tolerance = 1e-10;
  const ImpactDerivatives told = sim::contact::derivatives_of(asked, plain);
  DerivativeError error;
  if (!plain.separated) return error;
  const double speed = std::hypot(job.initial.vt_m_s, job.initial.vn_m_s, job.initial.vb_m_s);
  const OutcomeScales scales{speed, speed / job.body.radius_m(), plain.contact_s,
                             plain.max_deflection_m, plain.max_force_n};
  sim::contact::JobNumbers<double> numbers(job);
  const auto inputs = sim::contact::numbers_of(job, numbers);
  for (std::size_t c = first; c < inputs.size(); c += stride) {
    const auto& input = inputs[c];
    const bool ranged = input.key.rfind("contact.", 0) == 0 || input.key == "initial.gap_m" ||
                        input.key == "environment.gravity_m_s2";
    if (ranged && *input.number <= 0) continue;
    const auto table = differences(job, input.key, input.scale, scales);
    if (!table) continue;
    for (const auto& entry : table->front()) {
      const auto [best, moved] = extrapolated(*table, entry.first);
      if (!(moved < converged)) {
        ++error.undecided;
        continue;
      }
      const std::size_t r = place_of(told.outcomes, entry.first);
      compare(error, entry.first + " by " + input.key,
              told.values[r * told.inputs.size() + c] * input.scale / scale_of(entry.first, scales),
              best);
    }
  }
  return error;
}

}  // namespace impactdic::support
