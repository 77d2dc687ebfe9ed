#include "sim/sweep/sweep.h"

#include <impactdic/error.h>

#include <cmath>
#include <limits>

#include "host/base/parallel/parallel_for.h"
#include "sim/contact/impact.h"
#include "sim/contact/rebound.h"
#include "sim/rod/rod_impact.h"

namespace impactdic::sim::sweep {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
// A contact point slower than this part of the body has no direction of its own.
constexpr double kNoSlip = 1e-9;

SweepShot unknown_shot() {
  SweepShot shot;
  for (double* value : {&shot.restitution, &shot.tangential_restitution, &shot.friction,
                        &shot.rolling_cap, &shot.contact_s, &shot.max_deflection_m,
                        &shot.max_force_n, &shot.dent_m, &shot.kinetic_before_j, &shot.lost}) {
    *value = kUnknown;
  }
  for (BodyState* state : {&shot.before, &shot.after}) {
    state->vt_m_s = state->vn_m_s = state->vb_m_s = kUnknown;
    state->omega_rad_s = state->omega_t_rad_s = state->omega_n_rad_s = kUnknown;
  }
  return shot;
}

double tangential_restitution(double before, double after, double speed) {
  return std::abs(before) > kNoSlip * speed ? -after / before : kUnknown;
}

double speed_of(const BodyState& s) { return std::hypot(s.vt_m_s, s.vn_m_s, s.vb_m_s); }

// One spelling for what repeats, as a phase does after each switch.
void append_phase(std::string& list, const std::string& name) {
  const std::size_t last = list.rfind('+');
  if (list.substr(last == std::string::npos ? 0 : last + 1) == name) return;
  list += (list.empty() ? "" : "+") + name;
}

BodyState state_of(const ImpactVelocities& v) {
  BodyState s;
  s.vt_m_s = v.vt_m_s, s.vn_m_s = v.vn_m_s, s.omega_rad_s = v.omega_rad_s;
  return s;
}

void take_friction(SweepShot& shot, const ImpactBody& body, double contact_s, double gravity_m_s2,
                   double surface_angle_deg) {
  if (body.shape == BodyShape::kRod) return;
  const EffectiveFriction friction = contact::effective_friction(
      body, shot.before, shot.after, contact_s, gravity_m_s2, surface_angle_deg);
  shot.friction = friction.sound;
  shot.rolling_cap = friction.rolling_cap;
}

SweepShot run(const ImpactJob& job) {
  const ImpactResult result = contact::simulate_impact(job);
  SweepShot shot = unknown_shot();
  shot.status = result.separated ? SweepStatus::kSeparated : SweepStatus::kHeld;
  shot.before = result.start;
  shot.kinetic_before_j = result.energy.kinetic_start_j;
  shot.max_deflection_m = result.max_deflection_m;
  shot.max_force_n = result.max_force_n;
  for (const ContactPhase& phase : result.phases) {
    if (phase.kind == ContactPhaseKind::kTangential) append_phase(shot.phases, phase.name);
  }
  shot.warnings = result.warnings;
  if (!result.separated) return shot;
  shot.after = result.final;
  shot.restitution = result.restitution;
  shot.contact_s = result.contact_s;
  shot.tangential_restitution = tangential_restitution(
      result.tip_vt_start_m_s, result.tip_vt_final_m_s, speed_of(result.start));
  if (!job.other) {
    take_friction(shot, job.body, result.contact_s, job.gravity_m_s2, job.surface_angle_deg);
  }
  shot.lost = 1 - result.energy.kinetic_j / result.energy.kinetic_start_j;
  return shot;
}

SweepShot run(const ReboundJob& job) {
  const ReboundResult result = contact::simulate_rebound(job);
  SweepShot shot = unknown_shot();
  shot.status = SweepStatus::kSeparated;
  shot.before = state_of(result.before), shot.after = state_of(result.after);
  shot.restitution = result.restitution;
  shot.kinetic_before_j = result.kinetic_before_j;
  shot.lost = 1 - result.kinetic_after_j / result.kinetic_before_j;
  if (job.body.shape != BodyShape::kRod) {
    const double radius = job.body.radius_m();
    shot.tangential_restitution = tangential_restitution(
        result.before.vt_m_s + radius * result.before.omega_rad_s,
        result.after.vt_m_s + radius * result.after.omega_rad_s, speed_of(shot.before));
    take_friction(shot, job.body, 0, 0, 0);
  }
  shot.warnings = result.warnings;
  return shot;
}

SweepShot run(const RodModel& model) {
  RodJob job = model.rod;
  job.sample_rate_hz = 0;
  const RodImpact result = rod::simulate_rod(job);
  SweepShot shot = unknown_shot();
  // A rod that had not left has a warning instead of a restitution.
  shot.status = std::isnan(result.restitution) ? SweepStatus::kHeld : SweepStatus::kSeparated;
  shot.before = state_of({job.vt_m_s, job.vn_m_s, job.omega_rad_s});
  shot.kinetic_before_j = result.energy.kinetic_before_j;
  shot.max_deflection_m = result.max_compression_m;
  shot.max_force_n = result.max_force_n;
  shot.dent_m = result.residual_m;
  shot.micro_impacts = result.micro_impacts;
  for (const RodPhase& phase : result.friction_phases) append_phase(shot.phases, phase.name);
  shot.warnings = result.warnings;
  if (shot.status == SweepStatus::kHeld) return shot;
  shot.after = state_of({result.vt_m_s, result.vn_m_s, result.omega_rad_s});
  shot.restitution = result.restitution;
  shot.contact_s = result.contact_s;
  shot.lost = 1 - result.energy.kinetic_after_j / result.energy.kinetic_before_j;
  return shot;
}

}  // namespace

SweepShot run_shot(const SweepModel& model) {
  try {
    return std::visit([](const auto& job) { return run(job); }, model);
  } catch (const Error& error) {
    SweepShot shot = unknown_shot();
    shot.reason = (error.where().empty() ? "" : error.where() + ": ") + error.what();
    return shot;
  }
}

SweepResult run_sweep(const SweepRequest& request, const RunControl& control) {
  request.validate();
  SweepResult result;
  result.shots.assign(request.size(), unknown_shot());
  const std::vector<char> done =
      parallel_pieces(result.shots.size(), request.threads, "sweep", control,
                      [&](std::size_t i) { result.shots[i] = run_shot(request.shot(i)); });
  for (std::size_t i = 0; i < done.size(); ++i) {
    if (done[i]) continue;
    result.cancelled = true;
    result.shots[i].reason = "not begun";
  }
  return result;
}

}  // namespace impactdic::sim::sweep
