#include "sim/job/job_toml.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include "sim/job/contact_toml.h"
#include "sim/job/materials_toml.h"
#include "sim/job/strict_toml.h"
#include "sim/job/toml_text.h"

namespace impactdic::sim::job {

std::string model_of_job(const std::filesystem::path& file) {
  StrictTable root(file);
  const std::string model = root.text("model", "");
  for (const char* known :
       {"", "kelvin_voigt", "garwin", "cross", "walton", "stronge", "rigid_rod", "flexible_rod"}) {
    if (model == known) return model;
  }
  throw InvalidArgument("'" + model + "' is not known", root.place("model"),
                        "kelvin_voigt, garwin, cross, walton, stronge, rigid_rod or flexible_rod; "
                        "other laws are chosen by normal and friction");
}

ModelPreset read_preset(StrictTable& root, ModelPreset fallback) {
  return choose(root, "preset", std::string(name_of(fallback)), parse_preset);
}

namespace {

// In kilograms, or of a solid sphere from its density.
double read_mass(StrictTable& table, const ImpactBody& body, bool partial) {
  if (!table.has("density_kg_m3")) return needed(table, "mass_kg", partial);
  if (body.shape != BodyShape::kSolidSphere || table.has("mass_kg")) {
    throw InvalidArgument("is for a solid_sphere without mass_kg", table.place("density_kg_m3"));
  }
  const double density = table.number("density_kg_m3");
  if (!(density > 0)) throw InvalidArgument("must be positive", table.place("density_kg_m3"));
  return density * kPi / 6 * body.diameter_m * body.diameter_m * body.diameter_m;
}

}  // namespace

ImpactBody read_body(StrictTable& table, bool partial) {
  ImpactBody body;
  const bool inertia_given = table.has("inertia_kg_m2");
  body.shape = choose(table, "shape", inertia_given ? "other" : "solid_sphere", parse_shape);
  body.diameter_m = needed(table, "diameter_m", partial);
  body.mass_kg = read_mass(table, body, partial);
  if (body.shape == BodyShape::kRod) body.length_m = needed(table, "length_m", partial);
  body.inertia_kg_m2 = table.number("inertia_kg_m2", 0);
  if (inertia_given && !(body.inertia_kg_m2 > 0)) {
    throw InvalidArgument("must be positive", table.place("inertia_kg_m2"));
  }
  return body;
}

namespace {

void read_motion(StrictTable& table, InitialMotion& motion) {
  motion.vt_m_s = table.number("vt_m_s", 0);
  motion.vb_m_s = table.number("vb_m_s", 0);
  motion.vn_m_s = table.number("vn_m_s", 0);
  motion.omega_rad_s = table.number("omega_rad_s", 0);
  motion.omega_t_rad_s = table.number("omega_t_rad_s", 0);
  motion.omega_n_rad_s = table.number("omega_n_rad_s", 0);
}

OtherBody read_other(StrictTable& table) {
  OtherBody other;
  other.body = read_body(table, false);
  read_motion(table, other.initial);
  return other;
}

}  // namespace

ImpactJob read_impact_tables(StrictTable& root, bool partial) {
  ImpactJob job;
  const bool kelvin_voigt = root.text("model", "") == "kelvin_voigt";
  if (kelvin_voigt && root.has("normal")) {
    throw InvalidArgument("the model names the normal law already", root.place("normal"));
  }
  if (!kelvin_voigt) {
    job.normal = choose(root, "normal", "linear_spring_damper", parse_normal_model);
  }
  job.friction = choose(root, "friction", "coulomb", parse_friction_model);
  job.preset = read_preset(root, ModelPreset::kSound);
  job.body = read_body(root.table("body"), partial);
  StrictTable& contact = root.table("contact");
  if (root.has("other")) job.other = read_other(root.table("other"));
  job.surface_angle_deg = root.table("surface").number("angle_deg", 0);
  job.surface_radius_m = root.table("surface").number("radius_m", 0);
  if (kelvin_voigt) {
    job.contact = read_kelvin_voigt(contact, job);
  } else {
    job.materials = read_materials(root, contact, job);
    job.contact = read_contact(contact, job, partial);
    if (job.materials) take_materials(contact, job, *job.materials);
  }
  StrictTable& initial = root.table("initial");
  read_motion(initial, job.initial);
  job.initial.vn_m_s = needed(initial, "vn_m_s", partial);
  job.initial.gap_m = initial.number("gap_m", 0);
  if (job.body.shape == BodyShape::kRod)
    job.initial.angle_deg = needed(initial, "angle_deg", partial);
  job.gravity_m_s2 = root.table("environment").number("gravity_m_s2", 9.81);
  if (root.has("shell")) {
    StrictTable& shell = root.table("shell");
    BallShell given;
    given.stiffness_n_per_m = needed(shell, "stiffness_n_per_m", partial);
    given.damping_n_s_per_m = shell.number("damping_n_s_per_m", 0);
    given.flat_fraction = shell.number("flat_fraction", given.flat_fraction);
    job.shell = given;
  }
  if (root.has("air")) {
    StrictTable& air = root.table("air");
    job.air.density_kg_m3 = air.number("density_kg_m3", job.air.density_kg_m3);
    job.air.drag_coefficient = air.number("drag_coefficient", 0);
    job.air.lift_coefficient = air.number("lift_coefficient", 0);
  }
  StrictTable& solver = root.table("solver");
  job.solver.relative_tolerance =
      solver.number("relative_tolerance", job.solver.relative_tolerance);
  job.solver.contacts = solver.integer("contacts", job.solver.contacts);
  return job;
}

SimulateRequest read_simulate_job(const std::filesystem::path& file) {
  StrictTable root(file);
  const SimulateRequest job = read_simulate_tables(root);
  root.finish();
  validate_in_file(job, root);
  return job;
}

SimulateRequest read_simulate_tables(StrictTable& root) {
  SimulateRequest job;
  const std::string model = root.text("model", "");
  if (!model.empty() && model != "kelvin_voigt") {
    throw InvalidArgument("'" + model + "' has no integrated path of a ball", root.place("model"),
                          "name the laws with normal and friction");
  }
  // Both must be named: a forgotten line must not choose a law.
  if (model.empty()) root.text("normal");
  root.text("friction");
  job.impact = read_impact_tables(root, false);
  StrictTable& output = root.table("output");
  job.rate_hz = output.number("rate_hz", 0);
  job.derivatives = output.boolean("derivatives", false);
  return job;
}

namespace {

void write_motion(TomlText& text, const InitialMotion& motion) {
  text.number("vt_m_s", motion.vt_m_s);
  text.number("vn_m_s", motion.vn_m_s);
  text.number("vb_m_s", motion.vb_m_s);
  text.number("omega_rad_s", motion.omega_rad_s);
  text.number("omega_t_rad_s", motion.omega_t_rad_s);
  text.number("omega_n_rad_s", motion.omega_n_rad_s);
}

}  // namespace

std::string to_toml(const SimulateRequest& job) {
  const ImpactJob& impact = job.impact;
  TomlText text;
  text.name("normal", name_of(impact.normal));
  text.name("friction", name_of(impact.friction));
  text.name("preset", name_of(impact.preset));
  text.body(impact.body);
  const bool elastic = impact.materials && impact.materials->body.young_pa > 0;
  if (elastic) write_material(text, impact.materials->body);
  if (impact.other) {
    text.body(impact.other->body, "other");
    if (elastic) write_material(text, impact.materials->surface);
    write_motion(text, impact.other->initial);
  }
  write_contact(text, impact);
  text.table("surface");
  text.number("angle_deg", impact.surface_angle_deg);
  if (!impact.other) text.number("radius_m", impact.surface_radius_m);
  if (elastic && !impact.other) write_material(text, impact.materials->surface);
  text.table("initial");
  write_motion(text, impact.initial);
  text.number("gap_m", impact.initial.gap_m);
  if (impact.body.shape == BodyShape::kRod) text.number("angle_deg", impact.initial.angle_deg);
  text.table("environment");
  text.number("gravity_m_s2", impact.gravity_m_s2);
  write_shell(text, impact);
  write_air(text, impact.air);
  text.table("solver");
  text.number("relative_tolerance", impact.solver.relative_tolerance);
  text.integer("contacts", impact.solver.contacts);
  text.table("output");
  text.number("rate_hz", job.rate_hz);
  if (job.derivatives) text.boolean("derivatives", true);
  return text.str();
}

void write_shell(TomlText& text, const ImpactJob& job) {
  if (!job.shell) return;
  text.table("shell");
  text.number("stiffness_n_per_m", job.shell->stiffness_n_per_m);
  text.number("damping_n_s_per_m", job.shell->damping_n_s_per_m);
  text.number("flat_fraction", job.shell->flat_fraction);
}

void write_air(TomlText& text, const AirForces& air) {
  if (!air.act()) return;
  text.table("air");
  text.number("density_kg_m3", air.density_kg_m3);
  text.number("drag_coefficient", air.drag_coefficient);
  text.number("lift_coefficient", air.lift_coefficient);
}

}  // namespace impactdic::sim::job
