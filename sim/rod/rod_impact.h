// The blow of a round-ended rod, integrated; axes and equations in impactdic/rod_model.h.
#pragma once

#include <impactdic/rod_model.h>

namespace impactdic::sim::rod {

// Integrates the blow with an adaptive Dormand-Prince 5(4), its step capped at 1/20 of the shortest
// modal period, each change of phase located as an event. Throws InvalidArgument for an impossible
// job and where the tip does not approach the flat.
RodImpact simulate_rod(const RodJob& job);

}  // namespace impactdic::sim::rod
