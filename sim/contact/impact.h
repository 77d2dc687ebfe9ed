// Integration of one impact: trajectory, phases, energy.
#pragma once

#include <impactdic/impact_model.h>

#include <span>

namespace impactdic::sim::contact {

// Which points of the motion are kept. The default keeps none (fastest).
struct Recording {
  // > 0: at every multiple of 1 / rate_hz from t = 0 to the separation, and there.
  double rate_hz = 0;
  // At these times instead, ascending. Times before t = 0 or after the last separation are met by
  // free flight, so a measured track can be compared frame by frame.
  std::span<const double> times_s = {};
};

// Integrates the job with an adaptive Dormand-Prince 5(4) method and every switch of the contact
// located as an event. Where the energy ledger does not close to 1e-9 of the initial kinetic energy
// the tolerance is tightened. Throws InvalidArgument (job.validate()), or Error where the body
// never touches the surface or the ledger still does not close.
ImpactResult simulate_impact(const ImpactJob& job, const Recording& recording = {});

// `after`: where the contact ends, contact_s later. Lengths in metres, angles as in ImpactJob.
EffectiveFriction effective_friction(const ImpactBody& body, const BodyState& before,
                                     const BodyState& after, double contact_s, double gravity_m_s2,
                                     double surface_angle_deg);

}  // namespace impactdic::sim::contact
