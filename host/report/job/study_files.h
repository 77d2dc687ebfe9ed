// What `impactdic study` writes. Each throws FileError.
#pragma once

#include <impactdic/study.h>

#include <filesystem>

namespace impactdic::report {

// patterns.csv, one row a pattern, motion and estimator, and summary.json: pooled errors by
// estimator, by group of patterns and by pattern, and the findings.
void write_study(const std::filesystem::path& folder, const PatternStudyRequest& request,
                 const PatternStudyResult& result);
// density.csv, one row a number of points and method; window.csv and window_spline.csv,
// x_px,y_px,grey row by row; summary.json.
void write_study(const std::filesystem::path& folder, const DensityStudyResult& result);

}  // namespace impactdic::report
