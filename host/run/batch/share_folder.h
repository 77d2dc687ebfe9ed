// How a shared batch begins: its name, what its processes agree on, and its list of shots.
#pragma once

#include <impactdic/batch.h>

#include <string>
#include <vector>

#include "host/cluster/work_queue.h"
#include "host/run/batch/shot_runner.h"

namespace impactdic::run {

// Throws InvalidArgument naming the setting.
void check_share(const BatchRequest& request);

// Of this process: its machine, number and start.
std::string member_name();
cluster::QueueOptions queue_options(const BatchRequest& request, const std::string& member);
double steady_seconds();
bool text_is_gone(const std::string& beat);

// All settings of the batch, as text.
std::string share_settings(const BatchRequest& request);

// Makes the folder of results ready, for one of the processes alone, and gives a line a shot.
// Throws as `batch` does before anything is measured.
std::vector<std::string> start_share(const BatchRequest& request, const Session& session,
                                     const ShotRunner& runner);

// The share that the folder of results holds; with request.share.name that one. Throws
// InvalidArgument where there is none, or more than one to choose from.
std::string share_to_join(const BatchRequest& request);

}  // namespace impactdic::run
