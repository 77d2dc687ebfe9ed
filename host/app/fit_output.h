// What `impactdic fit` writes.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "sim/fit/calibration.h"

namespace impactdic::app {

// summary.json of a fit, parameters.csv (one row a shot), and for the published grid errors_N.csv
// (stiffness, damping, E_d, E_v, product, sum: Figs 3.25-3.28) and errors_spline_N.csv (Fig. 3.29)
// of shot N in the job's order. Each throws FileError.
void write_fit(const std::filesystem::path& folder, const sim::fit::FitJob& job,
               const sim::fit::FitResult& result);

// Parts of it that a comparison writes too.
nlohmann::ordered_json shot_json(const sim::shot::Shot& shot);
nlohmann::ordered_json pooled_json(const std::vector<sim::fit::PooledEstimate>& pooled);
nlohmann::ordered_json fits_json(const sim::fit::FitResult& result);

}  // namespace impactdic::app
