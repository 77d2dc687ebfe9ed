#include "sim/job/source_jobs.h"

#include <impactdic/units.h>

#include <cmath>

namespace impactdic::sim::job {

ImpactJob racket_job() {
  ImpactJob job;
  job.preset = ModelPreset::kPublished;
  job.normal = NormalModel::kLinearSpringDamper;
  job.friction = FrictionModel::kCoulomb;
  job.body = {BodyShape::kHollowSphere, 0.0567, 0.067};
  job.contact.stiffness = 13385;
  job.contact.damping_n_s_per_m = 5.36;
  job.contact.friction_kinetic = 0.0335;
  job.surface_angle_deg = 15;
  job.initial.vt_m_s = -2 * std::sin(15 * kRadPerDeg);
  job.initial.vn_m_s = -2 * std::cos(15 * kRadPerDeg);
  return job;
}

ImpactJob wood_published_job() {
  ImpactJob job;
  job.preset = ModelPreset::kPublished;
  job.normal = NormalModel::kHertzDamper;
  job.friction = FrictionModel::kThreePhase;
  job.body = {BodyShape::kSolidSphere, 0.14566, 0.06325};
  job.contact.stiffness = 875000;
  job.contact.damping_n_s_per_m = 9.5;
  job.contact.friction_kinetic = 0.54;
  job.contact.friction_static = 0.74;
  job.surface_angle_deg = 20;
  job.initial.vt_m_s = 0.57;
  job.initial.vn_m_s = -1.69;
  return job;
}

ImpactJob wood_sound_job() {
  ImpactJob job = wood_published_job();
  job.preset = ModelPreset::kSound;
  job.friction = FrictionModel::kMawBarberFawcett;
  job.contact.damping_n_s_per_m = 18;
  job.contact.friction_static = 0;
  job.contact.poisson = 0.49;
  job.surface_angle_deg = -20;
  return job;
}

ImpactJob alumina_job(double incidence_deg) {
  constexpr double kSpeed_m_s = 3.9, kDiameter_m = 5e-3, kDensity_kg_m3 = 4000;
  ImpactJob job;
  job.normal = NormalModel::kTsuji;
  job.friction = FrictionModel::kMawBarberFawcett;
  job.body = {BodyShape::kSolidSphere,
              kDensity_kg_m3 * kPi / 6 * kDiameter_m * kDiameter_m * kDiameter_m, kDiameter_m};
  job.contact.friction_kinetic = 0.092;
  job.contact.restitution_damping = RestitutionDamping::kToZeroForce;
  job.gravity_m_s2 = 0;
  job.initial.vt_m_s = kSpeed_m_s * std::sin(incidence_deg * kRadPerDeg);
  job.initial.vn_m_s = -kSpeed_m_s * std::cos(incidence_deg * kRadPerDeg);
  job.take_materials({{380e9, 0.23}, {70e9, 0.25}, 0.98, 0});
  return job;
}

}  // namespace impactdic::sim::job
