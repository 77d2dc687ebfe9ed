// The table [contact] of a job: each law reads its own constants.
#pragma once

#include <impactdic/impact_model.h>

namespace impactdic::sim::job {

class StrictTable;

// Of a job whose laws, body and materials are read; in a partial job constants may be missing.
// Throws InvalidArgument naming file and key.
ContactParameters read_contact(StrictTable& table, const ImpactJob& job, bool partial);
// A Kelvin-Voigt contact: stiffness and damping as they stand, or from what they give.
ContactParameters read_kelvin_voigt(StrictTable& table, const ImpactJob& job);

}  // namespace impactdic::sim::job
