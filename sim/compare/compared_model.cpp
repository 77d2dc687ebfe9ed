#include "sim/compare/compared_model.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <cmath>

#include "sim/contact/closed_form.h"

namespace impactdic::sim::compare {
namespace {

constexpr std::string_view kKelvinVoigt = "kelvin_voigt";

// The contact of the laws without friction, for what decides the normal motion alone.
contact::ImpactResult normal_contact(contact::ImpactJob job) {
  job.friction = contact::FrictionModel::kNone;
  return contact::simulate_impact(job);
}

ModelPrediction integrated(const contact::ImpactJob& job) {
  const contact::ImpactResult impact = contact::simulate_impact(job);
  return {
      impact.restitution, impact.final.vt_m_s,        impact.final.vn_m_s, impact.final.omega_rad_s,
      impact.contact_s,   impact.t_max_compression_s, impact.phases,       job};
}

// A spring and damper of the same restitution and duration, damped to the end.
ModelPrediction kelvin_voigt(contact::ImpactJob job) {
  const contact::ImpactResult law = normal_contact(job);
  const bool published = job.preset == contact::Preset::kPublished;
  const contact::SpringDamperParameters pair =
      published ? contact::kelvin_voigt_parameters(job.body.mass_kg, law.restitution, law.contact_s)
                : contact::force_free_parameters(job.body.mass_kg, law.restitution, law.contact_s);
  job.normal = contact::NormalModel::kLinearSpringDamper;
  job.contact.stiffness = pair.stiffness;
  job.contact.damping_n_s_per_m = pair.damping_n_s_per_m;
  job.contact.restitution_damping = published ? contact::RestitutionDamping::kToZeroDeflection
                                              : contact::RestitutionDamping::kToZeroForce;
  // Partial slip needs the pressure of a Hertz contact; its rigid limit does not.
  if (job.friction == contact::FrictionModel::kMawBarberFawcett)
    job.friction = contact::FrictionModel::kCoulomb;
  return integrated(job);
}

ModelPrediction by_formula(contact::ReboundModel model, const contact::ImpactJob& job,
                           const FormulaParameters& formula) {
  contact::ReboundJob rebound;
  rebound.model = model;
  rebound.preset = job.preset;
  rebound.body = job.body;
  rebound.restitution =
      std::isnan(formula.restitution) ? normal_contact(job).restitution : formula.restitution;
  rebound.tangential_restitution = formula.tangential_restitution;
  rebound.friction_kinetic = job.contact.friction_kinetic;
  rebound.initial = job.initial;
  const contact::ReboundResult result = contact::simulate_rebound(rebound);
  return {result.restitution,
          result.after.vt_m_s,
          result.after.vn_m_s,
          result.after.omega_rad_s,
          kNotMeasured,
          kNotMeasured,
          {},
          std::nullopt};
}

}  // namespace

std::string_view name_of(const ComparedModel& model) {
  if (const auto* friction = std::get_if<contact::FrictionModel>(&model))
    return contact::name_of(*friction);
  if (const auto* rebound = std::get_if<contact::ReboundModel>(&model))
    return contact::name_of(*rebound);
  return kKelvinVoigt;
}

ComparedModel parse_compared_model(std::string_view name) {
  if (name == kKelvinVoigt) return KelvinVoigt{};
  if (contact::is_rebound_model(name)) return contact::parse_rebound_model(name);
  try {
    return contact::parse_friction_model(name);
  } catch (const InvalidArgument& error) {
    throw InvalidArgument(error.what(), error.where(),
                          error.hint() + ", kelvin_voigt, garwin, cross, walton, stronge");
  }
}

ModelPrediction predict_shot(const ComparedModel& model, const contact::ImpactJob& job,
                             const FormulaParameters& formula) {
  if (const auto* rebound = std::get_if<contact::ReboundModel>(&model)) {
    return by_formula(*rebound, job, formula);
  }
  if (const auto* friction = std::get_if<contact::FrictionModel>(&model)) {
    contact::ImpactJob with = job;
    with.friction = *friction;
    return integrated(with);
  }
  return kelvin_voigt(job);
}

}  // namespace impactdic::sim::compare
