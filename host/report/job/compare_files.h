// What `impactdic compare` writes.
#pragma once

#include <impactdic/compare.h>

#include <filesystem>

namespace impactdic::report {

// summary.json, comparison.csv (one row a shot and model, as the tables of sections 3.3.2 and 4.4),
// phases.csv (when each model slides, sticks, turns), restitution.csv (one row a shot, Figs 3.21,
// 3.23 and 4.8) and restitution_by_angle.csv (Figs 3.22 and 3.24). Each throws FileError.
void write_comparison(const std::filesystem::path& folder, const CompareRequest& job,
                      const CompareResult& result);

// comparison.csv and summary.json of blows of a rod. Each throws FileError.
void write_rod_comparison(const std::filesystem::path& folder, const RodCompareRequest& job,
                          const RodCompareResult& result);

}  // namespace impactdic::report
