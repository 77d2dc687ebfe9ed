#include "sim/job/job_toml.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include "sim/contact/closed_form.h"
#include "sim/job/materials_toml.h"
#include "sim/job/strict_toml.h"
#include "sim/job/toml_text.h"

namespace impactdic::sim::job {

namespace {

// One of our enumerations, its error placed in the file.
template <typename Parser>
auto choose(StrictTable& table, const std::string& key, const std::string& fallback,
            Parser parser) {
  const std::string text = table.text(key, fallback);
  try {
    return parser(text);
  } catch (const InvalidArgument& error) {
    throw InvalidArgument("'" + text + "' is not known", table.place(key), error.hint());
  }
}

// A number that a complete job must give.
double needed(StrictTable& table, const char* key, bool partial) {
  return partial ? table.number(key, 0) : table.number(key);
}

ContactParameters read_contact(StrictTable& table, const ImpactJob& job, bool partial) {
  ContactParameters contact;
  if (has_spring_damper(job)) {
    // Materials, where they are given, say it once more (take_materials).
    const bool follows = job.normal == NormalModel::kHertzDamper &&
                         !table.has(stiffness_key(job)) && job.materials &&
                         job.materials->body.young_pa > 0;
    if (!follows) contact.stiffness = needed(table, stiffness_key(job), partial);
    contact.damping_n_s_per_m = table.number("damping_n_s_per_m", 0);
    contact.restitution_damping =
        choose(table, "restitution_damping", "none", parse_restitution_damping);
    const std::string takes = std::string(name_of(job.normal)) + " takes " + stiffness_key(job);
    table.hint("stiffness_n_per_m", takes);
    table.hint("stiffness_n_per_m1p5", takes);
  } else {
    const bool follows = job.materials && job.materials->body.young_pa > 0;
    contact.reduced_modulus_pa = needed(table, "reduced_modulus_pa", partial || follows);
    contact.yield_strength_pa = needed(table, "yield_strength_pa", partial);
    contact.poisson = needed(table, "poisson", partial);
    contact.residual = choose(table, "residual", "jackson", parse_residual_law);
  }
  if (job.friction != FrictionModel::kNone) {
    contact.friction_kinetic = needed(table, "friction_kinetic", partial);
  }
  if (job.friction == FrictionModel::kThreePhase) {
    contact.friction_static = needed(table, "friction_static", partial);
  } else {
    table.hint("friction_static", "only three_phase has a static friction");
  }
  if (job.friction == FrictionModel::kMawBarberFawcett) {
    const bool follows = job.materials && job.materials->body.young_pa > 0;
    contact.poisson = needed(table, "poisson", partial || follows);
  }
  return contact;
}

// A Kelvin-Voigt contact: stiffness and damping as they stand, or from what they give.
ContactParameters read_kelvin_voigt(StrictTable& table, const ImpactJob& job) {
  ContactParameters contact;
  const bool published = job.preset == ModelPreset::kPublished;
  contact.restitution_damping =
      published ? RestitutionDamping::kToZeroDeflection : RestitutionDamping::kToZeroForce;
  if (table.has("restitution")) {
    const double restitution = table.number("restitution"), duration = table.number("contact_s");
    if (!(restitution > 0 && restitution <= 1)) {
      throw InvalidArgument("must be above 0 and at most 1", table.place("restitution"));
    }
    if (!(duration > 0)) throw InvalidArgument("must be positive", table.place("contact_s"));
    const contact::SpringDamperParameters pair =
        published ? contact::kelvin_voigt_parameters(job.body.mass_kg, restitution, duration)
                  : contact::force_free_parameters(job.body.mass_kg, restitution, duration);
    contact.stiffness = pair.stiffness;
    contact.damping_n_s_per_m = pair.damping_n_s_per_m;
  } else {
    contact.stiffness = table.number("stiffness_n_per_m");
    contact.damping_n_s_per_m = table.number("damping_n_s_per_m");
  }
  if (job.friction != FrictionModel::kNone) {
    contact.friction_kinetic = table.number("friction_kinetic");
  }
  if (job.friction == FrictionModel::kThreePhase) {
    contact.friction_static = table.number("friction_static");
  }
  return contact;
}

}  // namespace

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
  text.table("solver");
  text.number("relative_tolerance", impact.solver.relative_tolerance);
  text.integer("contacts", impact.solver.contacts);
  text.table("output");
  text.number("rate_hz", job.rate_hz);
  return text.str();
}

void write_contact(TomlText& text, const ImpactJob& job) {
  const ContactParameters& contact = job.contact;
  text.table("contact");
  if (has_spring_damper(job)) {
    text.number(stiffness_key(job), contact.stiffness);
    text.number("damping_n_s_per_m", contact.damping_n_s_per_m);
    text.name("restitution_damping", name_of(contact.restitution_damping));
    if (job.materials && job.materials->restitution > 0) {
      text.number("restitution", job.materials->restitution);
      if (job.normal == NormalModel::kHertzDamper) {
        text.number("restitution_speed_m_s", job.materials->restitution_speed_m_s);
      }
    }
    if (job.materials && job.materials->body.young_pa > 0) {
      text.number("reduced_modulus_pa", contact.reduced_modulus_pa);
    }
  } else {
    text.number("reduced_modulus_pa", contact.reduced_modulus_pa);
    text.number("yield_strength_pa", contact.yield_strength_pa);
    text.name("residual", name_of(contact.residual));
  }
  // Beyond those of the job's own friction: what other models of a comparison need.
  if (!has_spring_damper(job) || job.friction == FrictionModel::kMawBarberFawcett ||
      contact.poisson != 0) {
    text.number("poisson", contact.poisson);
  }
  if (job.friction != FrictionModel::kNone || contact.friction_kinetic != 0) {
    text.number("friction_kinetic", contact.friction_kinetic);
  }
  if (job.friction == FrictionModel::kThreePhase || contact.friction_static != 0) {
    text.number("friction_static", contact.friction_static);
  }
}

}  // namespace impactdic::sim::job
