#include "host/python/impact_job.h"

#include "host/python/options.h"

namespace nb = nanobind;

namespace impactdic::python {
namespace {

// Reads `key` and hands it to one of the library's parsers.
template <typename Parser, typename T>
void choose(OptionReader& reader, const char* key, T& to, Parser parse) {
  std::string word;
  reader(key, word);
  if (!word.empty()) to = parse(word);
}

OptionReader table(const nb::dict& job, const char* name) {
  if (!job.contains(name)) return OptionReader(nb::dict());
  const nb::object found = job[name];
  if (!nb::isinstance<nb::dict>(found)) throw InvalidArgument("must be a dictionary", name);
  return OptionReader(nb::cast<nb::dict>(found));
}

ImpactBody read_body(OptionReader reader) {
  ImpactBody body;
  reader("mass_kg", body.mass_kg);
  reader("diameter_m", body.diameter_m);
  reader("length_m", body.length_m);
  reader("inertia_kg_m2", body.inertia_kg_m2);
  if (body.inertia_kg_m2 > 0) body.shape = BodyShape::kOther;
  choose(reader, "shape", body.shape, parse_shape);
  reader.finish("body");
  return body;
}

ContactParameters read_contact(OptionReader reader, NormalModel normal) {
  ContactParameters contact;
  if (!stiffness_key(normal).empty()) {
    reader(std::string(stiffness_key(normal)), contact.stiffness);
  }
  reader("damping_n_s_per_m", contact.damping_n_s_per_m);
  reader("damping_factor", contact.damping_factor);
  reader("dissipation_s", contact.dissipation_s);
  reader("damping_s_per_m", contact.damping_s_per_m);
  reader("unloading_stiffness_n_per_m", contact.unloading_stiffness_n_per_m);
  reader("unloading_hardening_per_m", contact.unloading_hardening_per_m);
  reader("adhesion_j_m2", contact.adhesion_j_per_m2);
  reader("tangential_stiffness_n_per_m", contact.tangential_stiffness_n_per_m);
  reader("friction_speed_m_s", contact.friction_speed_m_s);
  reader("rolling_friction", contact.rolling_friction);
  reader("spinning_friction", contact.spinning_friction);
  choose(reader, "restitution_damping", contact.restitution_damping, parse_restitution_damping);
  reader("friction_kinetic", contact.friction_kinetic);
  reader("friction_static", contact.friction_static);
  reader("poisson", contact.poisson);
  reader("reduced_modulus_pa", contact.reduced_modulus_pa);
  reader("yield_strength_pa", contact.yield_strength_pa);
  choose(reader, "residual", contact.residual, parse_residual_law);
  reader.finish("contact");
  return contact;
}

}  // namespace

ImpactJob impact_job(const nb::dict& job) {
  ImpactJob impact;
  OptionReader root(job);
  choose(root, "normal", impact.normal, parse_normal_model);
  choose(root, "friction", impact.friction, parse_friction_model);
  choose(root, "preset", impact.preset, parse_preset);
  for (const char* name :
       {"body", "contact", "shell", "surface", "initial", "environment", "solver"}) {
    root.pass_over(name);
  }
  root.finish("impact");
  impact.body = read_body(table(job, "body"));
  impact.contact = read_contact(table(job, "contact"), impact.normal);
  OptionReader surface = table(job, "surface"), initial = table(job, "initial"),
               environment = table(job, "environment"), solver = table(job, "solver");
  if (job.contains("shell")) {
    OptionReader reader = table(job, "shell");
    BallShell& shell = impact.shell.emplace();
    reader("stiffness_n_per_m", shell.stiffness_n_per_m);
    reader("damping_n_s_per_m", shell.damping_n_s_per_m);
    reader("flat_fraction", shell.flat_fraction);
    reader.finish("shell");
  }
  surface("angle_deg", impact.surface_angle_deg);
  surface.finish("surface");
  initial("vt_m_s", impact.initial.vt_m_s);
  initial("vn_m_s", impact.initial.vn_m_s);
  initial("omega_rad_s", impact.initial.omega_rad_s);
  initial("vb_m_s", impact.initial.vb_m_s);
  initial("omega_t_rad_s", impact.initial.omega_t_rad_s);
  initial("omega_n_rad_s", impact.initial.omega_n_rad_s);
  initial("gap_m", impact.initial.gap_m);
  initial("angle_deg", impact.initial.angle_deg);
  initial.finish("initial");
  environment("gravity_m_s2", impact.gravity_m_s2);
  environment.finish("environment");
  solver("relative_tolerance", impact.solver.relative_tolerance);
  solver("contacts", impact.solver.contacts);
  solver.finish("solver");
  return impact;
}

}  // namespace impactdic::python
