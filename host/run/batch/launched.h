// What a batch takes from whoever started its process.
#pragma once

#include <impactdic/batch.h>
#include <impactdic/device.h>

#include <string>

namespace impactdic::run {

// Processes that a launcher has started together share the shots without being told, and those of
// one machine take its equal GPUs in turn. `shard`: "K/N" or "". Throws InvalidArgument for another
// text, or where the processes have no name in common; as choose_device.
void share_as_launched(const std::string& shard, BatchRequest& request, SessionOptions& session);

}  // namespace impactdic::run
