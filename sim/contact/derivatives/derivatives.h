// Derivatives of an impact by the numbers of its job.
//
// The same laws are integrated with numbers that carry their derivatives (forward differentiation
// of the motion, the sensitivity equations). A switch of a law happens at an instant that moves
// with the inputs; the state there, and what the law remembers of it, move with it, so that the
// derivatives go through the switch as they must (the saltation of Aizerman and Gantmakher 1958).
#pragma once

#include <impactdic/impact_model.h>

#include <span>
#include <string>
#include <vector>

#include "sim/contact/contact_dynamics.h"

namespace impactdic::sim::contact {

// Of the outcome by all numbers that the job's laws read. `plain`: the impact itself. NaN where the
// body did not leave, or where the motion has no derivative, as at a slip that just ends. Throws as
// simulate_impact.
ImpactDerivatives derivatives_of(const ImpactJob& job, const ImpactResult& plain);

// The motion at some instants with its derivatives by some numbers.
struct SensitivePath {
  bool separated = false;
  std::vector<ImpactState> states;  // one a time; empty where the body did not leave
  // By input i of the state at time k: slopes[k * inputs + i].
  std::vector<ImpactState> slopes;
};
// `inputs`: as in ImpactDerivatives. Throws InvalidArgument for one that the job does not have,
// and as simulate_impact.
SensitivePath sensitive_path(const ImpactJob& job, std::span<const double> times_s,
                             std::span<const std::string> inputs);

}  // namespace impactdic::sim::contact
