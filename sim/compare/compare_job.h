// Compare jobs in TOML files.
#pragma once

#include <filesystem>
#include <string>

#include "sim/compare/comparison.h"

namespace impactdic::sim::compare {

// Throws FileError, FormatError, or InvalidArgument naming file and key. Relative paths start from
// the job file's folder.
CompareJob read_compare_job(const std::filesystem::path& file);
// With every default spelled out and absolute paths; reads back to the same job.
std::string to_toml(const CompareJob& job);

}  // namespace impactdic::sim::compare
