#include "sim/sweep/sweep.h"

#include <impactdic/models/sweep.h>

namespace impactdic {

SweepResult sweep(const SweepRequest& request, const RunControl& control) {
  return sim::sweep::run_sweep(request, control);
}

}  // namespace impactdic
