// Integration of one impact: trajectory, phases, energy.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "sim/contact/model.h"

namespace impactdic::sim::contact {

// Plane motion of the mass centre. qt counts from t = 0 and qn from the first touch of the surface,
// so that qn = -deflection for a ball in contact (the source's q1, q2, q3, its Eqs 3.1-3.4).
struct PlaneState {
  double qt_m = 0, qn_m = 0, angle_rad = 0;
  double vt_m_s = 0, vn_m_s = 0, omega_rad_s = 0;
};

// Energy in joules, since the start: kinetic_start_j + gravity_j = the sum of all others.
struct EnergyLedger {
  double kinetic_start_j = 0;
  double gravity_j = 0;  // work done by the weight
  double kinetic_j = 0;
  double normal_elastic_j = 0;      // stored, recoverable
  double damping_j = 0;             // dissipated by the damper
  double tangential_elastic_j = 0;  // stored in the tangential springs
  double slip_j = 0;                // dissipated by friction; negative where a rule feeds energy in
  double plastic_j = 0;             // kept by permanent deformation
  double residual_j = 0;            // what the integration lost
};

struct TrajectoryPoint {
  double time_s = 0;
  PlaneState state;
  double deflection_m = 0;
  double normal_force_n = 0, tangential_force_n = 0;
  double tip_vt_m_s = 0;  // tangential velocity of the contact point
  EnergyLedger energy;
};

enum class PhaseKind { kFlight, kNormal, kTangential };

struct Phase {
  PhaseKind kind = PhaseKind::kNormal;
  // flight; compression, restitution; sliding, sticking, post_sliding, rolling, reversed_sliding,
  // partial_slip, gross_slip, frictionless.
  const char* name = "";
  double start_s = 0, end_s = 0;
  double slip_j =
      0;  // tangential phases: dissipated by friction; negative: the rule feeds energy in
};

struct ImpactResult {
  bool separated = false;  // the body left the surface; otherwise it came to rest on it
  PlaneState start, final;
  double contact_start_s = 0;
  double contact_s = 0;  // duration of the first contact
  double t_max_compression_s =
      0;  // from the contact's start, as are the phases of a job without gap
  double max_deflection_m = 0;
  double max_force_n = 0;         // P_m: the normal force at the maximum compression
  double peak_force_n = 0;        // the largest normal force: a damper shifts it before that
  double separation_force_n = 0;  // normal force at that moment; negative: the surface pulls
  double restitution = 0;         // of the contact point's normal velocity (source Eq. 3.11)
  double tip_vt_start_m_s = 0, tip_vt_final_m_s = 0;
  double impulse_t_n_s = 0, impulse_n_n_s = 0;  // of the contact force
  std::vector<Phase> phases;
  EnergyLedger energy;
  std::vector<std::string> warnings;
  std::vector<TrajectoryPoint> trajectory;  // as Recording asks
  long evaluations = 0;                     // of the right-hand side
  long steps = 0;                           // accepted, of all contacts
};

// Which points of the motion are kept. The default keeps none (fastest).
struct Recording {
  double rate_hz =
      0;  // > 0: at every multiple of 1 / rate_hz from t = 0 to the separation, and there
  // At these times instead, ascending. Times before t = 0 or after the last separation are met by
  // free flight, so a measured track can be compared frame by frame.
  std::span<const double> times_s = {};
};

// Integrates the job with an adaptive Dormand-Prince 5(4) method and every switch of the contact
// located as an event. Throws InvalidArgument (job.validate()), or Error where the body never
// touches the surface.
ImpactResult simulate_impact(const ImpactJob& job, const Recording& recording = {});

// Effective friction of a measured or computed impact, an impulse ratio.
struct EffectiveFriction {
  double published = 0;    // Eq. 3.12: leaves gravity's impulse out
  double sound = 0;        // (dvt + g sin(angle) T) / (dvn + g cos(angle) T)
  double rolling_cap = 0;  // |vt0 + R omega0| / [(1 + 1/kappa)(1 + e)|vn0|]
};
EffectiveFriction effective_friction(const Body& body, const PlaneState& before,
                                     const PlaneState& after, double contact_s, double gravity_m_s2,
                                     double surface_angle_deg);

}  // namespace impactdic::sim::contact
