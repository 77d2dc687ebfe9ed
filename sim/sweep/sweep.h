// Many impacts of one model.
#pragma once

#include <impactdic/models/sweep.h>

namespace impactdic::sim::sweep {

// Runs every shot; throws as impactdic::sweep.
SweepResult run_sweep(const SweepRequest& request, const RunControl& control);

// One shot; failures of the model are in the result.
SweepShot run_shot(const SweepModel& model);

}  // namespace impactdic::sim::sweep
