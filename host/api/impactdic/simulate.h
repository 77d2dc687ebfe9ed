// Simulates one impact by a model: an integrated path, a formula, or the blow of a rod.
//
// All three are deterministic: the same request gives the same bits.
#pragma once

#include <impactdic/export.h>
#include <impactdic/impact_model.h>
#include <impactdic/rod_model.h>

#include <vector>

namespace IMPACTDIC_PUBLIC impactdic {

// An impact to integrate, and the points of its path that are kept.
struct SimulateRequest {
  ImpactJob impact;
  // Points per second, at every multiple of 1/rate_hz from t = 0 to the separation, and there;
  // 0: 200 points over the first contact.
  double rate_hz = 0;
  // At these times instead, s, ascending. Times before t = 0 or after the last separation are met
  // by free flight, so that a measured track can be compared frame by frame.
  std::vector<double> times_s;
  // Also the derivatives of the outcome by every number of the job (ImpactResult::derivatives).
  bool derivatives = false;

  // Throws InvalidArgument naming the key, as it stands in a job file.
  void validate() const;
};

// Integrates the laws with an adaptive Dormand-Prince 5(4) method and every switch of the contact
// located as an event. Where the energy ledger does not close to 1e-9 of the initial kinetic energy
// (ten times the relative tolerance, where that is more), the tolerance is tightened. Throws
// InvalidArgument (validate), or Error where the body never touches the surface, its contact cannot
// be followed or the ledger still does not close.
ImpactResult simulate(const SimulateRequest& request);

// The motion after by a formula. Throws InvalidArgument (validate).
ReboundResult simulate(const ReboundJob& job);

// The blow of a rod; the path is kept at job.sample_rate_hz. Throws InvalidArgument for an
// impossible job and where the tip does not approach the flat.
RodImpact simulate(const RodJob& job);

}  // namespace impactdic
