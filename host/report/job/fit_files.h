// What `impactdic fit` writes.
#pragma once

#include <impactdic/fit.h>

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace impactdic::report {

// summary.json of a fit, parameters.csv (one row a shot), and for the published grid errors_N.csv
// (stiffness, damping, E_d, E_v, product, sum: Figs 3.25-3.28) and errors_spline_N.csv (Fig. 3.29)
// of shot N in the job's order. Each throws FileError.
void write_fit(const std::filesystem::path& folder, const FitRequest& job, const FitResult& result);

// Parts of it that a comparison writes too.
nlohmann::ordered_json shot_json(const MeasuredShot& shot);
nlohmann::ordered_json pooled_json(const std::vector<PooledEstimate>& pooled);
nlohmann::ordered_json fits_json(const FitResult& result);

}  // namespace impactdic::report
