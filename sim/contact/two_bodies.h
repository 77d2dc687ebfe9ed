// Two balls that both move, as one against a surface that rests.
//
// The forces of a contact act on both alike, so the relative motion is that of one body: its mass
// is m1 m2/(m1 + m2), its radius that of the contact, and its inertia is such that a tangential
// force moves the contact point as it does between the two, R^2/I = R1^2/I1 + R2^2/I2. Both fall
// alike, so that it has no weight. The line of centres is taken not to turn during the contact.
#pragma once

#include <impactdic/impact_model.h>

#include "sim/contact/contact_dynamics.h"

namespace impactdic::sim::contact {

// The body that stands for both, in an impact of its own.
ImpactJob relative_job(const ImpactJob& job);
// The motion of the ball above the plane of contact (`side` 1) or of that below it (-1), from that
// of the body which stands for both.
template <typename Real>
ImpactStateOf<Real> state_of_ball(const JobNumbers<Real>& numbers, const Real& time_s,
                                  const ImpactStateOf<Real>& relative, int side);
// What the two do, from what that body does. Energies are those of both balls.
ImpactResult of_two_bodies(const ImpactJob& job, ImpactResult relative);

}  // namespace impactdic::sim::contact
