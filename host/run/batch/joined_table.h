// The last step of a shared batch: the results of all its processes in one table.
#pragma once

#include <impactdic/batch.h>

#include "host/cluster/work_queue.h"
#include "host/run/batch/shot_runner.h"

namespace impactdic::run {

// Every shot of the share as it is on the disk: done, failed or missing; processes that were lost
// are among the warnings. Throws FormatError.
BatchResult join_results(const BatchRequest& request, const ShotRunner& runner,
                         cluster::WorkQueue& queue);

// Writes shots.csv and, where wanted, the digests, and takes away what lost processes left half
// done. Throws FileError.
void write_joined(const BatchRequest& request, const ShotRunner& runner, const BatchResult& result);

}  // namespace impactdic::run
