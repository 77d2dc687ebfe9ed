#include "sim/job/result_files.h"

#include <impactdic/error.h>

#include <cmath>
#include <fstream>
#include <initializer_list>
#include <nlohmann/json.hpp>

#include "host/base/parse.h"

namespace impactdic::sim::job {

namespace {

using Json = nlohmann::ordered_json;

Json state_json(const BodyState& state) {
  return {{"qt_m", state.qt_m},
          {"qn_m", state.qn_m},
          {"angle_rad", state.angle_rad},
          {"vt_m_s", state.vt_m_s},
          {"vn_m_s", state.vn_m_s},
          {"omega_rad_s", state.omega_rad_s},
          {"qb_m", state.qb_m},
          {"vb_m_s", state.vb_m_s},
          {"omega_t_rad_s", state.omega_t_rad_s},
          {"omega_n_rad_s", state.omega_n_rad_s}};
}

// The columns of an impact that leaves the plane, and of a second ball.
constexpr const char* kSpaceColumns =
    ",qb_m,vb_m_s,omega_t_rad_s,omega_n_rad_s,tangential_force_b_n,tip_vb_m_s,"
    "orientation_w,orientation_t,orientation_n,orientation_b";
// Of a shell; the outline is what a camera sees.
constexpr const char* kShellColumns =
    ",vibration_j,flattening_m,flattening_rate_m_s,outline_qn_m,outline_vn_m_s";
constexpr const char* kOtherColumns =
    ",other_qt_m,other_qn_m,other_qb_m,other_vt_m_s,other_vn_m_s,other_vb_m_s,other_omega_rad_s,"
    "other_omega_t_rad_s,other_omega_n_rad_s";

void append(std::string& text, std::initializer_list<double> values) {
  for (const double value : values) text += ',' + shortest(value);
}

bool in_space(const ImpactJob& job) {
  return !job.initial.plane() || (job.other && !job.other->initial.plane());
}

Json energy_json(const EnergyLedger& energy) {
  return {{"kinetic_start_j", energy.kinetic_start_j},
          {"gravity_j", energy.gravity_j},
          {"kinetic_j", energy.kinetic_j},
          {"normal_elastic_j", energy.normal_elastic_j},
          {"damping_j", energy.damping_j},
          {"tangential_elastic_j", energy.tangential_elastic_j},
          {"slip_j", energy.slip_j},
          {"plastic_j", energy.plastic_j},
          {"residual_j", energy.residual_j}};
}

// What the laws took from the materials.
Json materials_json(const ImpactJob& job) {
  Json json;
  if (job.materials->body.young_pa > 0) {
    json["reduced_modulus_pa"] = job.contact.reduced_modulus_pa;
    json["contact_radius_m"] = job.contact_radius_m();
  }
  json["stiffness"] = job.contact.stiffness;
  if (const std::string key(damping_key(job.normal)); !key.empty()) {
    json[key] = job.contact.damping(job.normal);
  }
  return json;
}

Json phases_json(const std::vector<ContactPhase>& phases) {
  constexpr const char* kKinds[] = {"flight", "normal", "tangential"};
  Json list = Json::array();
  for (const ContactPhase& phase : phases) {
    Json entry = {{"name", phase.name},
                  {"kind", kKinds[static_cast<int>(phase.kind)]},
                  {"start_s", phase.start_s},
                  {"end_s", phase.end_s}};
    if (phase.kind == ContactPhaseKind::kTangential) entry["slip_j"] = phase.slip_j;
    list.push_back(entry);
  }
  return list;
}

}  // namespace

void write_trajectory_csv(const std::filesystem::path& file, const ImpactJob& job,
                          const std::vector<TrajectoryPoint>& trajectory) {
  const bool space = in_space(job);
  std::string text =
      "time_s,qt_m,qn_m,angle_rad,vt_m_s,vn_m_s,omega_rad_s,normal_force_n,tangential_force_n,"
      "deflection_m,tip_vt_m_s,gravity_j,kinetic_j,normal_elastic_j,damping_j,"
      "tangential_elastic_j,slip_j,plastic_j,residual_j";
  if (job.air.act()) text += ",air_j";
  if (job.shell) text += kShellColumns;
  if (space) text += kSpaceColumns;
  if (job.other) text += kOtherColumns;
  text += '\n';
  for (const TrajectoryPoint& point : trajectory) {
    const BodyState& state = point.state;
    const EnergyLedger& energy = point.energy;
    const double values[] = {point.time_s,
                             state.qt_m,
                             state.qn_m,
                             state.angle_rad,
                             state.vt_m_s,
                             state.vn_m_s,
                             state.omega_rad_s,
                             point.normal_force_n,
                             point.tangential_force_n,
                             point.deflection_m,
                             point.tip_vt_m_s,
                             energy.gravity_j,
                             energy.kinetic_j,
                             energy.normal_elastic_j,
                             energy.damping_j,
                             energy.tangential_elastic_j,
                             energy.slip_j,
                             energy.plastic_j,
                             energy.residual_j};
    char separator = 0;
    for (const double value : values) {
      if (separator != 0) text += separator;
      text += shortest(value);
      separator = ',';
    }
    if (job.air.act()) append(text, {energy.air_j});
    if (job.shell) {
      append(text, {energy.vibration_j, state.flattening_m, state.flattening_rate_m_s,
                    state.qn_m - state.outline_lag_m, state.vn_m_s - state.outline_lag_rate_m_s});
    }
    if (space) {
      const Quaternion& q = state.orientation;
      append(text, {state.qb_m, state.vb_m_s, state.omega_t_rad_s, state.omega_n_rad_s,
                    point.tangential_force_b_n, point.tip_vb_m_s, q.w, q.x, q.y, q.z});
    }
    if (job.other) {
      const BodyState& o = point.other;
      append(text, {o.qt_m, o.qn_m, o.qb_m, o.vt_m_s, o.vn_m_s, o.vb_m_s, o.omega_rad_s,
                    o.omega_t_rad_s, o.omega_n_rad_s});
    }
    text += '\n';
  }
  write_text(file, text);
}

void write_derivatives_csv(const std::filesystem::path& file, const ImpactDerivatives& d) {
  std::string text = "outcome";
  for (const std::string& input : d.inputs) text += ',' + input;
  text += '\n';
  for (std::size_t r = 0; r < d.outcomes.size(); ++r) {
    text += d.outcomes[r];
    for (std::size_t c = 0; c < d.inputs.size(); ++c) {
      const double value = d.values[r * d.inputs.size() + c];
      text += ',' + (std::isnan(value) ? std::string() : shortest(value));
    }
    text += '\n';
  }
  write_text(file, text);
}

std::string summary_json(const ImpactJob& job, const ImpactResult& result) {
  Json friction = nullptr;
  if (!job.other) {
    const EffectiveFriction f =
        contact::effective_friction(job.body, result.start, result.final, result.contact_s,
                                    job.gravity_m_s2, job.surface_angle_deg);
    friction = {{"published", f.published}, {"sound", f.sound}, {"rolling_cap", f.rolling_cap}};
  }
  Json summary = {{"normal", name_of(job.normal)},
                  {"friction", name_of(job.friction)},
                  {"preset", name_of(job.preset)},
                  {"separated", result.separated},
                  {"restitution", result.restitution},
                  {"contact_start_s", result.contact_start_s},
                  {"contact_s", result.contact_s},
                  {"t_max_compression_s", result.t_max_compression_s},
                  {"max_deflection_m", result.max_deflection_m},
                  {"max_force_n", result.max_force_n},
                  {"peak_force_n", result.peak_force_n},
                  {"separation_force_n", result.separation_force_n},
                  {"start", state_json(result.start)},
                  {"final", state_json(result.final)},
                  {"tip_vt_start_m_s", result.tip_vt_start_m_s},
                  {"tip_vt_final_m_s", result.tip_vt_final_m_s},
                  {"tip_vb_start_m_s", result.tip_vb_start_m_s},
                  {"tip_vb_final_m_s", result.tip_vb_final_m_s},
                  {"impulse",
                   {{"t_n_s", result.impulse_t_n_s},
                    {"n_n_s", result.impulse_n_n_s},
                    {"b_n_s", result.impulse_b_n_s}}},
                  {"effective_friction", friction},
                  {"phases", phases_json(result.phases)},
                  {"energy", energy_json(result.energy)},
                  {"warnings", result.warnings},
                  {"steps", result.steps},
                  {"evaluations", result.evaluations},
                  {"version", IMPACTDIC_VERSION}};
  if (job.other) {
    summary["other_start"] = state_json(result.other_start);
    summary["other_final"] = state_json(result.other_final);
  }
  if (job.air.act()) summary["energy"]["air_j"] = result.energy.air_j;
  if (job.shell) {
    summary["max_flattening_m"] = result.max_flattening_m;
    summary["own_frequency_hz"] = job.shell->own_frequency_hz(job.body.mass_kg);
    summary["energy"]["vibration_j"] = result.energy.vibration_j;
  }
  if (job.materials) summary["materials"] = materials_json(job);
  return summary.dump(2) + "\n";
}

void write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) throw FileError("cannot write", file.string(), "is the disk full?");
}

}  // namespace impactdic::sim::job
