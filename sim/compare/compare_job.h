// Compare jobs in TOML files.
#pragma once

#include <impactdic/compare.h>

#include <filesystem>
#include <string>

namespace impactdic::sim::compare {

// Throws FileError, FormatError, or InvalidArgument naming file and key. Relative paths start from
// the job file's folder.
CompareRequest read_compare_job(const std::filesystem::path& file);
// With every default spelled out and absolute paths; reads back to the same job.
std::string to_toml(const CompareRequest& job);

}  // namespace impactdic::sim::compare
