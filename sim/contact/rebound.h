// Impact models that are a formula: the motion after from the motion before, without a path, phases
// or a duration.
#pragma once

#include <impactdic/impact_model.h>

namespace impactdic::sim::contact {

// Throws InvalidArgument (job.validate()).
ReboundResult simulate_rebound(const ReboundJob& job);

}  // namespace impactdic::sim::contact
