// Rod models against a table of measured blows (source chapter 5).
#pragma once

#include <impactdic/compare.h>

#include <filesystem>
#include <string>

namespace impactdic::sim::compare {

// Whether the file is a compare job of a rod (body.shape = "rod"). Throws FileError, FormatError.
bool is_rod_compare_job(const std::filesystem::path& file);
// Throws FileError, FormatError, or InvalidArgument naming file and key.
RodCompareRequest read_rod_compare_job(const std::filesystem::path& file);
std::string to_toml(const RodCompareRequest& request);

RodCompareResult compare_rods(const RodCompareRequest& request, const RunControl& control = {});

}  // namespace impactdic::sim::compare
