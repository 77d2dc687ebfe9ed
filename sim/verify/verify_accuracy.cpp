// Rows of `impactdic verify`: conservation laws, limits, order of convergence, switch times.
#include <algorithm>
#include <cmath>

#include "sim/contact/closed_form.h"
#include "sim/contact/impact.h"
#include "sim/job/source_jobs.h"
#include "sim/verify/verify_cases.h"

namespace impactdic::sim::verify {

namespace {

struct NamedJob {
  std::string name;
  ImpactJob job;
};

ImpactJob steel_job(NormalModel normal) {
  ImpactJob job;
  job.normal = normal;
  job.friction = FrictionModel::kCoulomb;
  job.body = {BodyShape::kSolidSphere, 0.1, 0.02};
  job.contact.reduced_modulus_pa = 109.18e9;
  job.contact.yield_strength_pa = 300e6;
  job.contact.poisson = 0.3;
  job.contact.friction_kinetic = 0.2;
  job.initial.vt_m_s = 0.15;
  job.initial.vn_m_s = -0.3;
  return job;
}

// The lacrosse ball with another law; e is about 0.8.
ImpactJob rubber_job(NormalModel normal) {
  ImpactJob job = job::wood_sound_job();
  job.normal = normal;
  job.friction = FrictionModel::kCoulomb;
  job.contact.poisson = 0;
  job.contact.restitution_damping = RestitutionDamping::kToZeroForce;
  job.contact.damping_factor = 0.16;
  job.contact.dissipation_s = 2e-4;
  job.contact.damping_s_per_m = 0.12;
  if (normal == NormalModel::kWaltonBraun) {
    job.contact.stiffness = 4e4;
    job.contact.unloading_stiffness_n_per_m = 6e4;
  }
  return job;
}

// A soft sphere that hardly comes off.
ImpactJob gel_job() {
  ImpactJob job;
  job.normal = NormalModel::kJkr;
  job.friction = FrictionModel::kCoulomb;
  job.body = {BodyShape::kSolidSphere, 4e-6, 2e-3};
  job.contact.reduced_modulus_pa = 1e6;
  job.contact.adhesion_j_per_m2 = 0.1;
  job.contact.friction_kinetic = 0.2;
  job.initial.vt_m_s = 0.05;
  job.initial.vn_m_s = -0.1;
  return job;
}

// The normal laws beside the dissertation's, and friction that falls with the speed.
void add_other_normals(std::vector<NamedJob>& jobs) {
  for (const NormalModel normal : {NormalModel::kTsuji, NormalModel::kKuwabaraKono,
                                   NormalModel::kHuntCrossley, NormalModel::kWaltonBraun}) {
    jobs.push_back({std::string(name_of(normal)), rubber_job(normal)});
  }
  jobs.push_back({"stronge_elastoplastic", steel_job(NormalModel::kStronge)});
  jobs.push_back({"jkr", gel_job()});
  ImpactJob fading = job::racket_job();
  fading.friction = FrictionModel::kSpeedDependent;
  fading.contact.friction_static = 0.6;
  fading.contact.friction_speed_m_s = 0.5;
  jobs.push_back({"speed_dependent", fading});
}

// Contacts that give way along the surface.
void add_elastic_frictions(std::vector<NamedJob>& jobs) {
  for (const NormalModel normal :
       {NormalModel::kTsuji, NormalModel::kKuwabaraKono, NormalModel::kHuntCrossley}) {
    ImpactJob partial = rubber_job(normal);
    partial.friction = FrictionModel::kMindlin;
    partial.contact.poisson = 0.49;
    jobs.push_back({std::string(name_of(normal)) + ", mindlin", partial});
  }
  for (const NormalModel normal : {NormalModel::kThornton, NormalModel::kStronge}) {
    ImpactJob partial = steel_job(normal);
    partial.friction = FrictionModel::kMindlin;
    jobs.push_back({std::string(name_of(normal)) + ", mindlin", partial});
  }
  for (const FrictionModel friction :
       {FrictionModel::kMindlin, FrictionModel::kTangentialSpring, FrictionModel::kGripSlip}) {
    ImpactJob spring = job::racket_job();
    spring.friction = friction;
    spring.contact.poisson = 0.3;
    spring.contact.friction_kinetic = 0.3;
    spring.contact.friction_static = 0.5;
    spring.contact.tangential_stiffness_n_per_m = 1e4;
    jobs.push_back({"linear_spring_damper, " + std::string(name_of(friction)), spring});
  }
}

// Every normal law, every friction law, both presets.
std::vector<NamedJob> every_model() {
  std::vector<NamedJob> jobs;
  for (const RestitutionDamping damping :
       {RestitutionDamping::kNone, RestitutionDamping::kToZeroForce,
        RestitutionDamping::kToZeroDeflection}) {
    ImpactJob job = job::racket_job();
    job.contact.restitution_damping = damping;
    jobs.push_back({"linear_spring_damper, " + std::string(name_of(damping)), job});
  }
  for (const RestitutionDamping damping :
       {RestitutionDamping::kToZeroForce, RestitutionDamping::kToZeroDeflection}) {
    ImpactJob job = job::wood_sound_job();
    job.contact.restitution_damping = damping;
    jobs.push_back({"maw_barber_fawcett, " + std::string(name_of(damping)), job});
    job.friction = FrictionModel::kCoulomb;
    job.contact.poisson = 0;
    jobs.push_back({"hertz_damper, " + std::string(name_of(damping)), job});
  }
  for (const ModelPreset preset : {ModelPreset::kPublished, ModelPreset::kSound}) {
    for (const FrictionModel friction :
         {FrictionModel::kNone, FrictionModel::kCoulomb, FrictionModel::kThreePhase,
          FrictionModel::kFullSliding, FrictionModel::kBrody}) {
      ImpactJob job = job::wood_published_job();
      job.preset = preset;
      job.friction = friction;
      jobs.push_back({std::string(name_of(friction)) + ", " + std::string(name_of(preset)), job});
    }
  }
  jobs.push_back({"maw_barber_fawcett", job::wood_sound_job()});
  for (const NormalModel normal :
       {NormalModel::kJacksonGreen, NormalModel::kKogutEtsion, NormalModel::kThornton}) {
    jobs.push_back({std::string(name_of(normal)), steel_job(normal)});
    ImpactJob other = steel_job(normal);
    other.contact.residual = ResidualLaw::kKogutEtsion;
    if (normal == NormalModel::kThornton) continue;  // it has a residual of its own
    jobs.push_back({std::string(name_of(normal)) + ", residual kogut_etsion", other});
  }
  add_other_normals(jobs);
  add_elastic_frictions(jobs);
  return jobs;
}

void add_energy(std::vector<VerifyCase>& cases) {
  for (const NamedJob& named : every_model()) {
    cases.push_back({"energy", named.name + ": residual / initial kinetic energy", "conservation",
                     0, 1e-9, [job = named.job] {
                       const EnergyLedger energy = contact::simulate_impact(job).energy;
                       return energy.residual_j / energy.kinetic_start_j;
                     }});
  }
}

void add_momentum(std::vector<VerifyCase>& cases) {
  for (const NamedJob& named : every_model()) {
    ImpactJob job = named.job;
    job.gravity_m_s2 = 0;
    job.initial.omega_rad_s = 5;
    // Both forces go through the contact point.
    cases.push_back({"angular momentum about the contact", named.name + ", relative change",
                     "conservation", 0, 1e-9, [job] {
                       const ImpactResult r = contact::simulate_impact(job);
                       const auto momentum = [&](const BodyState& s) {
                         return job.body.inertia() * s.omega_rad_s -
                                job.body.mass_kg * job.body.radius_m() * s.vt_m_s;
                       };
                       return momentum(r.final) / momentum(r.start) - 1;
                     }});
  }
}

void add_limits(std::vector<VerifyCase>& cases) {
  const std::string group = "limits";
  ImpactJob job = job::wood_sound_job();
  job.gravity_m_s2 = 0;
  ImpactJob elastic = job;
  elastic.contact.damping_n_s_per_m = 0;
  cases.push_back({group, "no damping: restitution", "limit: elastic", 1, 1e-9,
                   [elastic] { return contact::simulate_impact(elastic).restitution; }});
  ImpactJob smooth = job;
  smooth.friction = FrictionModel::kNone;
  cases.push_back({group, "no friction: tangential velocity kept, m/s", "limit: frictionless",
                   smooth.initial.vt_m_s, 1e-13,
                   [smooth] { return contact::simulate_impact(smooth).final.vt_m_s; }});
  ImpactJob slippery = job;
  slippery.contact.friction_kinetic = 1e-9;
  cases.push_back({group, "maw_barber_fawcett, friction to 0: as no friction, m/s",
                   "limit: frictionless", job.initial.vt_m_s, 1e-8,
                   [slippery] { return contact::simulate_impact(slippery).final.vt_m_s; }});
  // With unbounded friction nothing slips but the springs that leave the contact, so the rebound no
  // longer depends on it.
  cases.push_back({group, "maw_barber_fawcett, full grip: friction no longer matters, m/s",
                   "limit: grip", 0, 2e-3, [elastic] {
                     ImpactJob grip = elastic;
                     const auto tip = [&grip](double friction) {
                       grip.contact.friction_kinetic = friction;
                       return contact::simulate_impact(grip).tip_vt_final_m_s;
                     };
                     return tip(30) - tip(100);
                   }});
  // Sliding throughout, friction stops nothing: the impulse formula holds for any normal law.
  ImpactJob sliding = job;
  sliding.friction = FrictionModel::kCoulomb;
  sliding.contact.friction_kinetic = 0.02;
  cases.push_back({group, "coulomb sliding: as Walton's formula, m/s", "formula: Walton 1993", 0,
                   1e-9, [sliding] {
                     const ImpactResult r = contact::simulate_impact(sliding);
                     const ImpactVelocities exact = contact::walton_rebound(
                         sliding.body, {sliding.initial.vt_m_s, sliding.initial.vn_m_s, 0},
                         r.restitution, sliding.contact.friction_kinetic, 0);
                     return r.final.vt_m_s - exact.vt_m_s;
                   }});
  ImpactJob rolling = sliding;
  rolling.contact.friction_kinetic = 0.54;
  cases.push_back({group, "coulomb rolling: contact point at rest, m/s", "formula: Brody 1984", 0,
                   1e-9, [rolling] { return contact::simulate_impact(rolling).tip_vt_final_m_s; }});
  ImpactJob racket = job::racket_job();
  cases.push_back({group, "effective friction with gravity's impulse", "conservation",
                   racket.contact.friction_kinetic, 1e-10, [racket] {
                     const ImpactResult r = contact::simulate_impact(racket);
                     return contact::effective_friction(racket.body, r.start, r.final, r.contact_s,
                                                        racket.gravity_m_s2,
                                                        racket.surface_angle_deg)
                         .sound;
                   }});
}

ImpactResult at_tolerance(ImpactJob job, double tolerance) {
  job.solver.relative_tolerance = tolerance;
  return contact::simulate_impact(job);
}

// The largest difference of a phase's limit from a run at 1e-13, s.
double switch_error_s(const ImpactJob& job, double tolerance) {
  const ImpactResult run = at_tolerance(job, tolerance), exact = at_tolerance(job, 1e-13);
  if (run.phases.size() != exact.phases.size()) return std::nan("");
  double largest = 0;
  for (std::size_t i = 0; i < run.phases.size(); ++i) {
    largest = std::max({largest, std::abs(run.phases[i].start_s - exact.phases[i].start_s),
                        std::abs(run.phases[i].end_s - exact.phases[i].end_s)});
  }
  return largest;
}

void add_convergence(std::vector<VerifyCase>& cases) {
  for (const NamedJob& named : every_model()) {
    const ImpactJob job = named.job;
    cases.push_back({"switch times", named.name + ": error at rtol 1e-10, s",
                     "regression, against rtol 1e-13", 0, 1e-12,
                     [job] { return switch_error_s(job, 1e-10); }});
  }
  cases.push_back({"convergence", "order of the method, linear spring-damper",
                   "formula: Dormand & Prince 1980", 5, 0.6, [] {
                     ImpactJob job = job::racket_job();
                     job.gravity_m_s2 = 0;
                     const double exact =
                         contact::linear_impact(job.body.mass_kg, job.contact.stiffness,
                                                job.contact.damping_n_s_per_m, -job.initial.vn_m_s)
                             .restitution;
                     const ImpactResult coarse = at_tolerance(job, 1e-8);
                     const ImpactResult fine = at_tolerance(job, 1e-11);
                     return std::log(std::abs(coarse.restitution - exact) /
                                     std::abs(fine.restitution - exact)) /
                            std::log(static_cast<double>(fine.steps) / coarse.steps);
                   }});
}

}  // namespace

std::vector<VerifyCase> accuracy_cases() {
  std::vector<VerifyCase> cases;
  add_energy(cases);
  add_momentum(cases);
  add_limits(cases);
  add_convergence(cases);
  return cases;
}

}  // namespace impactdic::sim::verify
