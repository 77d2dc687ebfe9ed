// Fit jobs in TOML files.
#pragma once

#include <filesystem>
#include <string>

#include "sim/fit/calibration.h"

namespace impactdic::sim::fit {

// Throws FileError, FormatError, or InvalidArgument naming file and key. Relative paths of tracks
// start from the job file's folder.
FitRequest read_fit_job(const std::filesystem::path& file);
// With every default spelled out and absolute paths; reads back to the same job.
std::string to_toml(const FitRequest& job);

}  // namespace impactdic::sim::fit
