// Sweeps in TOML files: a job of `simulate` with a table [sweep].
#pragma once

#include <impactdic/models/sweep.h>

#include <filesystem>
#include <string>

namespace impactdic::sim::sweep {

// Whether the job has a table [sweep]. Throws FileError or FormatError.
bool is_sweep_job(const std::filesystem::path& file);

// Axes stand as in the file. What is swept may be left out elsewhere, and takes the place of what
// stands there. Throws FileError, FormatError, or InvalidArgument naming file and key.
SweepRequest read_sweep_job(const std::filesystem::path& file);
// With every default spelled out; reads back to the same job.
std::string to_toml(const SweepRequest& job);

}  // namespace impactdic::sim::sweep
