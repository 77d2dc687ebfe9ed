#include "sim/rod/rod_job.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host/base/parse.h"
#include "sim/job/job_toml.h"
#include "sim/job/strict_toml.h"
#include "sim/job/toml_text.h"

namespace impactdic::sim::rod {
namespace {

PlasticLoading loading_of(job::StrictTable& root) {
  const std::string name = root.text("normal", "jackson_green");
  if (name == name_of(NormalModel::kJacksonGreen)) return PlasticLoading::kJacksonGreen;
  if (name == name_of(NormalModel::kKogutEtsion)) return PlasticLoading::kKogutEtsion;
  if (name == name_of(NormalModel::kThornton)) return PlasticLoading::kThornton;
  if (name == name_of(NormalModel::kStronge)) return PlasticLoading::kStronge;
  throw InvalidArgument("a rod needs an elastic-plastic law", root.place("normal"),
                        "jackson_green, kogut_etsion, thornton or stronge_elastoplastic");
}

std::string_view name_of_loading(PlasticLoading loading) {
  switch (loading) {
    case PlasticLoading::kJacksonGreen:
      return name_of(NormalModel::kJacksonGreen);
    case PlasticLoading::kKogutEtsion:
      return name_of(NormalModel::kKogutEtsion);
    case PlasticLoading::kThornton:
      return name_of(NormalModel::kThornton);
    case PlasticLoading::kStronge:
      return name_of(NormalModel::kStronge);
  }
  return "";
}

ResidualLaw read_residual(job::StrictTable& table, ResidualLaw fallback) {
  const std::string text = table.text("residual", std::string(name_of(fallback)));
  try {
    return parse_residual_law(text);
  } catch (const InvalidArgument& error) {
    throw InvalidArgument(error.what(), table.place("residual"), error.hint());
  }
}

}  // namespace

RodModel read_rod_tables(job::StrictTable& root, bool flexible) {
  RodModel job;
  job.flexible = flexible;
  RodJob& rod = job.rod;
  rod = flexible ? flexible_rod_preset() : rigid_rod_preset();
  // Jackson's residual is the dissertation's; Kogut and Etsion's comes nearer to its measurements.
  job.preset = job::read_preset(root, flexible ? ModelPreset::kSound : ModelPreset::kPublished);
  rod.residual =
      job.preset == ModelPreset::kPublished ? ResidualLaw::kJackson : ResidualLaw::kKogutEtsion;
  rod.loading = loading_of(root);
  job::StrictTable& body = root.table("body");
  const std::string shape(name_of(BodyShape::kRod));
  if (body.text("shape", shape) != shape) {
    throw InvalidArgument("the model is of a rod", body.place("shape"), "rod");
  }
  rod.body.length_m = body.number("length_m");
  rod.body.radius_m = body.number("diameter_m") / 2;
  rod.body.mass_kg = body.number("mass_kg");
  rod.surface.radius_m = rod.body.radius_m;
  if (flexible) {
    rod.body.young_pa = body.number("young_pa");
    rod.axial_modes = body.integer("axial_modes", rod.axial_modes);
    rod.bending_modes = body.integer("bending_modes", rod.bending_modes);
    rod.modal_damping = body.number("modal_damping", rod.modal_damping);
  }
  job::StrictTable& contact = root.table("contact");
  rod.surface.effective_modulus_pa = contact.number("reduced_modulus_pa");
  rod.surface.yield_strength_pa = contact.number("yield_strength_pa");
  rod.surface.poisson = contact.number("poisson");
  rod.residual = read_residual(contact, rod.residual);
  rod.friction_kinetic = contact.number("friction_kinetic");
  rod.gravity_m_s2 = root.table("environment").number("gravity_m_s2", rod.gravity_m_s2);
  job::StrictTable& solver = root.table("solver");
  rod.relative_tolerance = solver.number("relative_tolerance", rod.relative_tolerance);
  rod.longest_s = solver.number("longest_s", rod.longest_s);
  return job;
}

RodModel read_rod_job(const std::filesystem::path& file) {
  job::StrictTable root(file);
  const RodModel job = read_rod_model(root);
  root.finish();
  job::validate_in_file(job.rod, root);
  return job;
}

RodModel read_rod_model(job::StrictTable& root) {
  RodModel job = read_rod_tables(root, root.text("model") == "flexible_rod");
  RodJob& rod = job.rod;
  job::StrictTable& initial = root.table("initial");
  rod.angle_rad = initial.number("angle_deg") * kRadPerDeg;
  rod.vt_m_s = initial.number("vt_m_s", 0);
  rod.vn_m_s = initial.number("vn_m_s");
  rod.omega_rad_s = initial.number("omega_rad_s", 0);
  rod.sample_rate_hz = root.table("output").number("rate_hz", 1e6);
  return job;
}

void write_rod_tables(job::TomlText& text, const RodModel& job, bool with_residual) {
  const RodJob& rod = job.rod;
  text.name("normal", name_of_loading(rod.loading));
  text.table("body");
  text.name("shape", name_of(BodyShape::kRod));
  text.number("length_m", rod.body.length_m);
  text.number("diameter_m", 2 * rod.body.radius_m);
  text.number("mass_kg", rod.body.mass_kg);
  if (job.flexible) {
    text.number("young_pa", rod.body.young_pa);
    text.integer("axial_modes", rod.axial_modes);
    text.integer("bending_modes", rod.bending_modes);
    text.number("modal_damping", rod.modal_damping);
  }
  text.table("contact");
  text.number("reduced_modulus_pa", rod.surface.effective_modulus_pa);
  text.number("yield_strength_pa", rod.surface.yield_strength_pa);
  text.number("poisson", rod.surface.poisson);
  if (with_residual) text.name("residual", name_of(rod.residual));
  text.number("friction_kinetic", rod.friction_kinetic);
  text.table("environment");
  text.number("gravity_m_s2", rod.gravity_m_s2);
  text.table("solver");
  text.number("relative_tolerance", rod.relative_tolerance);
  text.number("longest_s", rod.longest_s);
}

std::string to_toml(const RodModel& job) {
  const RodJob& rod = job.rod;
  job::TomlText text;
  text.name("model", job.flexible ? "flexible_rod" : "rigid_rod");
  text.name("preset", name_of(job.preset));
  write_rod_tables(text, job, true);
  text.table("initial");
  text.number("angle_deg", rod.angle_rad * kDegPerRad);
  text.number("vt_m_s", rod.vt_m_s);
  text.number("vn_m_s", rod.vn_m_s);
  text.number("omega_rad_s", rod.omega_rad_s);
  text.table("output");
  text.number("rate_hz", rod.sample_rate_hz);
  return text.str();
}

void write_rod_trajectory(const std::filesystem::path& file, const RodImpact& impact) {
  std::ofstream out(file);
  out << "time_s,qt_m,qn_m,angle_rad,vt_m_s,vn_m_s,omega_rad_s,normal_force_n,tangential_force_n,"
         "compression_m,tip_vt_m_s,tip_vn_m_s\n";
  for (const RodSample& s : impact.trajectory) {
    bool first = true;
    for (double value :
         {s.time_s, s.x_m, s.y_m, s.angle_rad, s.vt_m_s, s.vn_m_s, s.omega_rad_s, s.normal_force_n,
          s.tangential_force_n, s.compression_m, s.tip_vt_m_s, s.tip_vn_m_s}) {
      out << (first ? "" : ",") << shortest(value);
      first = false;
    }
    out << '\n';
  }
  out.flush();
  if (!out) throw FileError("cannot write the file", file.string());
}

std::string rod_summary_json(const RodModel& job, const RodImpact& impact) {
  using Json = nlohmann::ordered_json;
  const auto phases = [](const std::vector<RodPhase>& list) {
    Json json = Json::array();
    for (const RodPhase& p : list) {
      json.push_back({{"name", p.name}, {"start_s", p.start_s}, {"end_s", p.end_s}});
    }
    return json;
  };
  const RodEnergy& e = impact.energy;
  // The first time the compression stops growing.
  double turn_s = 0;
  for (const RodPhase& p : impact.normal_phases) {
    if (p.name == "loading" && turn_s == 0) turn_s = p.end_s;
  }
  return Json{{"model", job.flexible ? "flexible_rod" : "rigid_rod"},
              {"preset", name_of(job.preset)},
              {"restitution", impact.restitution},
              {"contact_s", impact.contact_s},
              {"start_to_end_s", impact.start_to_end_s},
              {"micro_impacts", impact.micro_impacts},
              {"t_max_compression_s", turn_s},
              {"max_deflection_m", impact.max_compression_m},
              {"residual_m", impact.residual_m},
              {"max_force_n", impact.max_force_n},
              {"final",
               {{"vt_m_s", impact.vt_m_s},
                {"vn_m_s", impact.vn_m_s},
                {"omega_rad_s", impact.omega_rad_s}}},
              {"impulse",
               {{"normal_n_s", impact.normal_impulse_n_s},
                {"tangential_n_s", impact.tangential_impulse_n_s}}},
              {"phases", phases(impact.normal_phases)},
              {"friction_phases", phases(impact.friction_phases)},
              {"energy",
               {{"kinetic_before_j", e.kinetic_before_j},
                {"kinetic_after_j", e.kinetic_after_j},
                {"vibration_after_j", e.vibration_after_j},
                {"plastic_j", e.plastic_j},
                {"friction_j", e.friction_j},
                {"damping_j", e.damping_j},
                {"gravity_j", e.gravity_j},
                {"residual_j", e.residual_j}}},
              {"warnings", impact.warnings}}
             .dump(2) +
         "\n";
}

}  // namespace impactdic::sim::rod
