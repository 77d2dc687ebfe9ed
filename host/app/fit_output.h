// What `impactdic fit` and `impactdic compare` write.
#pragma once

#include <filesystem>

#include "sim/fit/comparison.h"

namespace impactdic::app {

// summary.json of a fit, parameters.csv (one row a shot), and for the published grid errors_N.csv
// (stiffness, damping, E_d, E_v, product, sum: Figs 3.25-3.28) and errors_spline_N.csv (Fig. 3.29)
// of shot N in the job's order. Each throws FileError.
void write_fit(const std::filesystem::path& folder, const FitJob& job, const FitResult& result);

// summary.json of a comparison, comparison.csv (one row a shot and model, as the tables of sections
// 3.3.2 and 4.4), restitution.csv (one row a shot, Figs 3.21, 3.23 and 4.8) and
// restitution_by_angle.csv (Figs 3.22 and 3.24).
void write_comparison(const std::filesystem::path& folder, const CompareJob& job,
                      const CompareResult& result);

}  // namespace impactdic::app
