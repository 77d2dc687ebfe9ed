// Derivatives of an impact by the numbers of its job.
//
// The same laws are integrated with numbers that carry their derivatives (forward differentiation
// of the motion, the sensitivity equations). A switch of a law happens at an instant that moves
// with the inputs; the state there, and what the law remembers of it, move with it, so that the
// derivatives go through the switch as they must (the saltation of Aizerman and Gantmakher 1958).
#pragma once

#include <impactdic/impact_model.h>

namespace impactdic::sim::contact {

// Of the outcome by all numbers that the job's laws read. `plain`: the impact itself. NaN where the
// body did not leave, or where the motion has no derivative, as at a slip that just ends. Throws as
// simulate_impact.
ImpactDerivatives derivatives_of(const ImpactJob& job, const ImpactResult& plain);

}  // namespace impactdic::sim::contact
