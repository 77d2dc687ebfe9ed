#include "sim/compare/compared_model.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <cmath>

#include "sim/contact/closed_form.h"
#include "sim/contact/impact.h"
#include "sim/contact/rebound.h"

namespace impactdic::sim::compare {
namespace {

// The contact of the laws without friction, for what decides the normal motion alone.
ImpactResult normal_contact(ImpactJob job) {
  job.friction = FrictionModel::kNone;
  return contact::simulate_impact(job);
}

ModelPrediction integrated(const ImpactJob& job) {
  const ImpactResult impact = contact::simulate_impact(job);
  return {
      impact.restitution, impact.final.vt_m_s,        impact.final.vn_m_s, impact.final.omega_rad_s,
      impact.contact_s,   impact.t_max_compression_s, impact.phases,       job};
}

// A spring and damper of the same restitution and duration, damped to the end.
ModelPrediction kelvin_voigt(ImpactJob job) {
  const ImpactResult law = normal_contact(job);
  const bool published = job.preset == ModelPreset::kPublished;
  const contact::SpringDamperParameters pair =
      published ? contact::kelvin_voigt_parameters(job.body.mass_kg, law.restitution, law.contact_s)
                : contact::force_free_parameters(job.body.mass_kg, law.restitution, law.contact_s);
  job.normal = NormalModel::kLinearSpringDamper;
  job.shell.reset();
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
  const ReboundResult result = contact::simulate_rebound(rebound);
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

}  // namespace impactdic::sim::compare
