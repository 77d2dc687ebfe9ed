#include "sim/impact/job_toml.h"

#include "host/base/error.h"
#include "host/base/parse.h"
#include "sim/impact/strict_toml.h"

namespace impactdic {

namespace {

bool has_spring_damper(const ImpactJob& job) {
  return job.normal == NormalModel::kLinearSpringDamper || job.normal == NormalModel::kHertzDamper;
}
const char* stiffness_key(const ImpactJob& job) {
  return job.normal == NormalModel::kHertzDamper ? "stiffness_n_per_m1p5" : "stiffness_n_per_m";
}

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

Body read_body(StrictTable& table, bool partial) {
  Body body;
  const bool inertia_given = table.has("inertia_kg_m2");
  body.shape = choose(table, "shape", inertia_given ? "other" : "solid_sphere", parse_shape);
  body.mass_kg = needed(table, "mass_kg", partial);
  body.diameter_m = needed(table, "diameter_m", partial);
  if (body.shape == Shape::kRod) body.length_m = needed(table, "length_m", partial);
  body.inertia_kg_m2 = table.number("inertia_kg_m2", 0);
  if (inertia_given && !(body.inertia_kg_m2 > 0)) {
    throw InvalidArgument("must be positive", table.place("inertia_kg_m2"));
  }
  return body;
}

Contact read_contact(StrictTable& table, const ImpactJob& job, bool partial) {
  Contact contact;
  if (has_spring_damper(job)) {
    contact.stiffness = needed(table, stiffness_key(job), partial);
    contact.damping_n_s_per_m = table.number("damping_n_s_per_m", 0);
    contact.restitution_damping =
        choose(table, "restitution_damping", "none", parse_restitution_damping);
    const std::string takes = std::string(name_of(job.normal)) + " takes " + stiffness_key(job);
    table.hint("stiffness_n_per_m", takes);
    table.hint("stiffness_n_per_m1p5", takes);
  } else {
    contact.reduced_modulus_pa = needed(table, "reduced_modulus_pa", partial);
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
    contact.poisson = needed(table, "poisson", partial);
  }
  return contact;
}

}  // namespace

ImpactJob read_impact_tables(StrictTable& root, bool partial) {
  ImpactJob job;
  job.normal = choose(root, "normal", "linear_spring_damper", parse_normal_model);
  job.friction = choose(root, "friction", "coulomb", parse_friction_model);
  job.preset = choose(root, "preset", "sound", parse_preset);
  job.body = read_body(root.table("body"), partial);
  job.contact = read_contact(root.table("contact"), job, partial);
  job.surface_angle_deg = root.table("surface").number("angle_deg", 0);
  StrictTable& initial = root.table("initial");
  job.initial.vt_m_s = initial.number("vt_m_s", 0);
  job.initial.vn_m_s = needed(initial, "vn_m_s", partial);
  job.initial.omega_rad_s = initial.number("omega_rad_s", 0);
  job.initial.gap_m = initial.number("gap_m", 0);
  if (job.body.shape == Shape::kRod) job.initial.angle_deg = needed(initial, "angle_deg", partial);
  job.gravity_m_s2 = root.table("environment").number("gravity_m_s2", 9.81);
  StrictTable& solver = root.table("solver");
  job.solver.relative_tolerance =
      solver.number("relative_tolerance", job.solver.relative_tolerance);
  job.solver.contacts = solver.integer("contacts", job.solver.contacts);
  return job;
}

SimulateJob read_simulate_job(const std::filesystem::path& file) {
  StrictTable root(file);
  SimulateJob job;
  // Both must be named: a forgotten line must not choose a law.
  root.text("normal");
  root.text("friction");
  job.impact = read_impact_tables(root, false);
  StrictTable& output = root.table("output");
  job.rate_hz = output.number("rate_hz", 0);
  if (job.rate_hz < 0) throw InvalidArgument("must not be negative", output.place("rate_hz"));
  root.finish();
  try {
    job.impact.validate();
  } catch (const InvalidArgument& error) {
    throw InvalidArgument(error.what(), root.place(error.where()), error.hint());
  }
  return job;
}

std::string to_toml(const SimulateJob& job) {
  const ImpactJob& impact = job.impact;
  const Body& body = impact.body;
  const Contact& contact = impact.contact;
  std::string text;
  const auto name = [&text](const char* key, std::string_view value) {
    text += std::string(key) + " = \"" + std::string(value) + "\"\n";
  };
  const auto number = [&text](const char* key, double value) {
    std::string digits = shortest(value);
    if (digits.find_first_of(".e") == std::string::npos) digits += ".0";
    text += std::string(key) + " = " + digits + "\n";
  };
  name("normal", name_of(impact.normal));
  name("friction", name_of(impact.friction));
  name("preset", name_of(impact.preset));
  text += "\n[body]\n";
  name("shape", name_of(body.shape));
  number("mass_kg", body.mass_kg);
  number("diameter_m", body.diameter_m);
  if (body.shape == Shape::kRod) number("length_m", body.length_m);
  if (body.inertia_kg_m2 != 0) number("inertia_kg_m2", body.inertia_kg_m2);
  text += "\n[contact]\n";
  if (has_spring_damper(impact)) {
    number(stiffness_key(impact), contact.stiffness);
    number("damping_n_s_per_m", contact.damping_n_s_per_m);
    name("restitution_damping", name_of(contact.restitution_damping));
  } else {
    number("reduced_modulus_pa", contact.reduced_modulus_pa);
    number("yield_strength_pa", contact.yield_strength_pa);
    name("residual", name_of(contact.residual));
  }
  if (!has_spring_damper(impact) || impact.friction == FrictionModel::kMawBarberFawcett) {
    number("poisson", contact.poisson);
  }
  if (impact.friction != FrictionModel::kNone) number("friction_kinetic", contact.friction_kinetic);
  if (impact.friction == FrictionModel::kThreePhase) {
    number("friction_static", contact.friction_static);
  }
  text += "\n[surface]\n";
  number("angle_deg", impact.surface_angle_deg);
  text += "\n[initial]\n";
  number("vt_m_s", impact.initial.vt_m_s);
  number("vn_m_s", impact.initial.vn_m_s);
  number("omega_rad_s", impact.initial.omega_rad_s);
  number("gap_m", impact.initial.gap_m);
  if (body.shape == Shape::kRod) number("angle_deg", impact.initial.angle_deg);
  text += "\n[environment]\n";
  number("gravity_m_s2", impact.gravity_m_s2);
  text += "\n[solver]\n";
  number("relative_tolerance", impact.solver.relative_tolerance);
  text += "contacts = " + std::to_string(impact.solver.contacts) + "\n";
  text += "\n[output]\n";
  number("rate_hz", job.rate_hz);
  return text;
}

}  // namespace impactdic
