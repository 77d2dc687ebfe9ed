#include "sim/fit/compared_model.h"

#include <cmath>

#include "host/base/error.h"
#include "host/base/units.h"
#include "sim/impact/closed_form.h"

namespace impactdic {
namespace {

constexpr std::string_view kKelvinVoigt = "kelvin_voigt";

// The contact of the laws without friction, for what decides the normal motion alone.
ImpactResult normal_contact(ImpactJob job) {
  job.friction = FrictionModel::kNone;
  return simulate_impact(job);
}

ModelPrediction integrated(const ImpactJob& job) {
  const ImpactResult impact = simulate_impact(job);
  return {
      impact.restitution, impact.final.vt_m_s,        impact.final.vn_m_s, impact.final.omega_rad_s,
      impact.contact_s,   impact.t_max_compression_s, impact.phases,       job};
}

// A spring and damper of the same restitution and duration, damped to the end.
ModelPrediction kelvin_voigt(ImpactJob job) {
  const ImpactResult law = normal_contact(job);
  const bool published = job.preset == Preset::kPublished;
  const SpringDamperParameters pair =
      published ? kelvin_voigt_parameters(job.body.mass_kg, law.restitution, law.contact_s)
                : force_free_parameters(job.body.mass_kg, law.restitution, law.contact_s);
  job.normal = NormalModel::kLinearSpringDamper;
  job.contact.stiffness = pair.stiffness;
  job.contact.damping_n_s_per_m = pair.damping_n_s_per_m;
  job.contact.restitution_damping =
      published ? RestitutionDamping::kToZeroDeflection : RestitutionDamping::kToZeroForce;
  // Partial slip needs the pressure of a Hertz contact; its rigid limit does not.
  if (job.friction == FrictionModel::kMawBarberFawcett) job.friction = FrictionModel::kCoulomb;
  return integrated(job);
}

ModelPrediction by_formula(ReboundModel model, const ImpactJob& job,
                           const FormulaParameters& formula) {
  ReboundJob rebound;
  rebound.model = model;
  rebound.preset = job.preset;
  rebound.body = job.body;
  rebound.restitution =
      std::isnan(formula.restitution) ? normal_contact(job).restitution : formula.restitution;
  rebound.tangential_restitution = formula.tangential_restitution;
  rebound.friction_kinetic = job.contact.friction_kinetic;
  rebound.initial = job.initial;
  const ReboundResult result = simulate_rebound(rebound);
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
  if (const auto* friction = std::get_if<FrictionModel>(&model)) return name_of(*friction);
  if (const auto* rebound = std::get_if<ReboundModel>(&model)) return name_of(*rebound);
  return kKelvinVoigt;
}

ComparedModel parse_compared_model(std::string_view name) {
  if (name == kKelvinVoigt) return KelvinVoigt{};
  if (is_rebound_model(name)) return parse_rebound_model(name);
  try {
    return parse_friction_model(name);
  } catch (const InvalidArgument& error) {
    throw InvalidArgument(error.what(), error.where(),
                          error.hint() + ", kelvin_voigt, garwin, cross, walton, stronge");
  }
}

ModelPrediction predict_shot(const ComparedModel& model, const ImpactJob& job,
                             const FormulaParameters& formula) {
  if (const auto* rebound = std::get_if<ReboundModel>(&model)) {
    return by_formula(*rebound, job, formula);
  }
  if (const auto* friction = std::get_if<FrictionModel>(&model)) {
    ImpactJob with = job;
    with.friction = *friction;
    return integrated(with);
  }
  return kelvin_voigt(job);
}

}  // namespace impactdic
