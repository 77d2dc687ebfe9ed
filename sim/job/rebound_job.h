// Jobs of the models that are a formula: `model = "garwin"`, "cross", "walton", "stronge".
#pragma once

#include <filesystem>
#include <string>

#include "sim/contact/rebound.h"

namespace impactdic::sim::job {

class StrictTable;

// Throws FileError, FormatError, or InvalidArgument naming file and key.
ReboundJob read_rebound_job(const std::filesystem::path& file);
// The same of a file that holds more; neither finished nor validated.
ReboundJob read_rebound_tables(StrictTable& root);
// With every default spelled out; reads back to the same job.
std::string to_toml(const ReboundJob& job);

// Two rows, before and after, both at time 0: the columns of the other models' trajectories, empty
// where a formula says nothing. Throws FileError.
void write_rebound_trajectory(const std::filesystem::path& file, const ReboundResult& result);
// The keys of the other models' summaries; null where a formula says nothing.
std::string rebound_summary_json(const ReboundJob& job, const ReboundResult& result);

}  // namespace impactdic::sim::job
