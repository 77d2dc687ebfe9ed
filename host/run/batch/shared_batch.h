// A batch whose shots several processes share.
#pragma once

#include <impactdic/batch.h>

#include <filesystem>

#include "host/run/control.h"

namespace impactdic::run {

// request.share is set. The member that does the last step returns every shot, the others those
// that they measured. Throws as `batch` does.
BatchResult shared_batch(const BatchRequest& request, Session& session, Caller& caller);

// Writes the table of what is there, and lists what is missing.
BatchResult join_shared_batch(const BatchRequest& request, Session& session, Caller& caller);

// Throws Error where processes that share `output` are at work in it.
void require_no_share_at_work(const std::filesystem::path& output);

}  // namespace impactdic::run
