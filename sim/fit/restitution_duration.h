// Stiffness and damping from the restitution and the duration of an impact.
#pragma once

#include <impactdic/impact_model.h>

#include "sim/contact/closed_form.h"

namespace impactdic::sim::fit {

// For the law, surface, gravity and initial motion of `job` (its stiffness and damping are
// ignored): the pair whose simulated impact has this restitution and duration, to 1e-10. The
// damping is the law's own constant, in its own unit (damping_key). Throws InvalidArgument where
// the law has no stiffness and damping, or no pair gives these figures.
contact::SpringDamperParameters spring_and_damper(ImpactJob job, double restitution,
                                                  double duration_s);

struct ContactTiming {
  double duration_s = 0;
  double crossing_s = 0;  // from the touch to where the two flights carried on cross
};

// The duration of the contact from a length that is measured far better than the instants of touch
// and separation: the height, above the lowest point of the path, where the two flights carried on
// would cross (negative: below it). At a given restitution that height grows with the duration, by
// the shape of the law of `job`. `start_s` is a first guess. Throws as spring_and_damper.
ContactTiming timing_from_crossing(const ImpactJob& job, double restitution,
                                   double crossing_above_lowest_m, double start_s);

}  // namespace impactdic::sim::fit
