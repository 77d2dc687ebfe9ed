// What a batch says at its end, and where its results lie.
#pragma once

#include <impactdic/batch.h>

#include "host/run/batch/shot_runner.h"
#include "host/run/control.h"

namespace impactdic::run {

// Makes the folder of the shots. Throws InvalidArgument where the clips lie in it; FileError.
void make_shots_folder(const ShotRunner& runner, const std::string& clips);

// Warns of shots that failed or are missing. Throws Error where none could be measured, or some are
// missing although the run was not cancelled.
void conclude_batch(const BatchRequest& request, Caller& caller, BatchResult& result);

}  // namespace impactdic::run
