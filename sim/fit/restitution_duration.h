// Stiffness and damping from the restitution and the duration of an impact.
#pragma once

#include "sim/impact/model.h"

namespace impactdic {

struct SpringAndDamper {
  double stiffness = 0;  // N/m, or N/m^1.5 for hertz_damper
  double damping_n_s_per_m = 0;
};

// Linear spring, damped in compression only, no gravity (zeta = b / (2 sqrt(k m))):
//   e = exp(-zeta acos(zeta) / sqrt(1 - zeta^2)),  omega0 T = acos(zeta) / sqrt(1 - zeta^2) + pi/2.
// Throws InvalidArgument unless 0 < e <= 1 and T > 0.
SpringAndDamper linear_closed_form(double mass_kg, double restitution, double duration_s);

// For the law, surface, gravity and initial motion of `job` (its stiffness and damping are
// ignored): the pair whose simulated impact has this restitution and duration, to 1e-10. Throws
// InvalidArgument where the law has no stiffness and damping, or no pair gives these figures.
SpringAndDamper spring_and_damper(ImpactJob job, double restitution, double duration_s);

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

}  // namespace impactdic
