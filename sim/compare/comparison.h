// Models against measured shots (source sections 3.3.2 and 4.4).
#pragma once

#include <impactdic/compare.h>

namespace impactdic::sim::compare {

// Calibrates where the request has shots for it (pooled values), then predicts every shot from its
// measured motion before the impact alone. Throws as calibrate.
CompareResult compare_shots(const CompareRequest& request, const RunControl& control = {});

}  // namespace impactdic::sim::compare
