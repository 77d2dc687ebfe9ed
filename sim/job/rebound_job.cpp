#include "sim/job/rebound_job.h"

#include <impactdic/error.h>

#include <nlohmann/json.hpp>

#include "host/base/parse.h"
#include "sim/contact/impact.h"
#include "sim/job/job_toml.h"
#include "sim/job/result_files.h"
#include "sim/job/strict_toml.h"
#include "sim/job/toml_text.h"

namespace impactdic::sim::job {
namespace {

using Json = nlohmann::ordered_json;

bool needs_restitution(const ReboundJob& job) {
  return job.model != ReboundModel::kGarwin || job.preset == ModelPreset::kSound;
}
bool needs_tangential(const ReboundJob& job) {
  return job.model == ReboundModel::kCross || job.model == ReboundModel::kWalton;
}
bool needs_friction(const ReboundJob& job) {
  return job.preset == ModelPreset::kSound || job.model == ReboundModel::kWalton ||
         job.model == ReboundModel::kStronge;
}

}  // namespace

ReboundJob read_rebound_job(const std::filesystem::path& file) {
  StrictTable root(file);
  const ReboundJob job = read_rebound_tables(root);
  root.finish();
  validate_in_file(job, root);
  return job;
}

ReboundJob read_rebound_tables(StrictTable& root) {
  ReboundJob job;
  job.model = parse_rebound_model(root.text("model"));
  job.preset = read_preset(root, ModelPreset::kSound);
  job.body = read_body(root.table("body"), false);
  StrictTable& contact = root.table("contact");
  if (needs_restitution(job)) job.restitution = contact.number("restitution");
  if (needs_tangential(job)) job.tangential_restitution = contact.number("tangential_restitution");
  if (needs_friction(job)) job.friction_kinetic = contact.number("friction_kinetic");
  job.surface_angle_deg = root.table("surface").number("angle_deg", 0);
  StrictTable& initial = root.table("initial");
  job.initial.vt_m_s = initial.number("vt_m_s", 0);
  job.initial.vn_m_s = initial.number("vn_m_s");
  job.initial.omega_rad_s = initial.number("omega_rad_s", 0);
  if (job.body.shape == BodyShape::kRod) job.initial.angle_deg = initial.number("angle_deg");
  return job;
}

std::string to_toml(const ReboundJob& job) {
  TomlText text;
  text.name("model", name_of(job.model));
  text.name("preset", name_of(job.preset));
  text.body(job.body);
  text.table("contact");
  if (needs_restitution(job)) text.number("restitution", job.restitution);
  if (needs_tangential(job)) text.number("tangential_restitution", job.tangential_restitution);
  if (needs_friction(job)) text.number("friction_kinetic", job.friction_kinetic);
  text.table("surface");
  text.number("angle_deg", job.surface_angle_deg);
  text.table("initial");
  text.number("vt_m_s", job.initial.vt_m_s);
  text.number("vn_m_s", job.initial.vn_m_s);
  text.number("omega_rad_s", job.initial.omega_rad_s);
  if (job.body.shape == BodyShape::kRod) text.number("angle_deg", job.initial.angle_deg);
  return text.str();
}

void write_rebound_trajectory(const std::filesystem::path& file, const ReboundResult& result) {
  std::string text =
      "time_s,qt_m,qn_m,angle_rad,vt_m_s,vn_m_s,omega_rad_s,normal_force_n,tangential_force_n\n";
  for (const ImpactVelocities& v : {result.before, result.after}) {
    text += "0,0,0,0," + shortest(v.vt_m_s) + "," + shortest(v.vn_m_s) + "," +
            shortest(v.omega_rad_s) + ",,\n";
  }
  write_text(file, text);
}

std::string rebound_summary_json(const ReboundJob& job, const ReboundResult& result) {
  const auto state = [](const ImpactVelocities& v) {
    return Json{{"vt_m_s", v.vt_m_s}, {"vn_m_s", v.vn_m_s}, {"omega_rad_s", v.omega_rad_s}};
  };
  const auto plane = [](const ImpactVelocities& v) {
    BodyState s;
    s.vt_m_s = v.vt_m_s, s.vn_m_s = v.vn_m_s, s.omega_rad_s = v.omega_rad_s;
    return s;
  };
  Json friction = nullptr;
  if (job.body.shape != BodyShape::kRod) {
    // Without a duration gravity has no impulse: both forms are one.
    const EffectiveFriction f =
        contact::effective_friction(job.body, plane(result.before), plane(result.after), 0, 0, 0);
    friction = {{"published", f.published}, {"sound", f.sound}, {"rolling_cap", f.rolling_cap}};
  }
  const Json summary = {
      {"model", name_of(job.model)},
      {"preset", name_of(job.preset)},
      {"restitution", result.restitution},
      {"contact_s", nullptr},
      {"t_max_compression_s", nullptr},
      {"max_deflection_m", nullptr},
      {"max_force_n", nullptr},
      {"start", state(result.before)},
      {"final", state(result.after)},
      {"impulse",
       {{"t_n_s", job.body.mass_kg * (result.after.vt_m_s - result.before.vt_m_s)},
        {"n_n_s", job.body.mass_kg * (result.after.vn_m_s - result.before.vn_m_s)}}},
      {"effective_friction", friction},
      {"phases", Json::array()},
      {"energy",
       {{"kinetic_start_j", result.kinetic_before_j},
        {"kinetic_j", result.kinetic_after_j},
        {"lost_j", result.kinetic_before_j - result.kinetic_after_j}}},
      {"warnings", result.warnings},
      {"version", IMPACTDIC_VERSION}};
  return summary.dump(2) + "\n";
}

}  // namespace impactdic::sim::job
