// The speckle study as a table and as a finding.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "host/study/pattern_study.h"

namespace impactdic::study {

// One row per pattern, motion and estimator. Throws FileError.
void write_pattern_csv(const std::filesystem::path& file, std::span<const PatternStudyRow> rows);

// What one estimator makes of one or several patterns, all motions pooled.
struct PooledErrors {
  std::string estimator;
  int pairs = 0, failed_pairs = 0;
  double motion_rms_px = 0, rot_rms_deg = 0;  // as `track` would state them; per axis
  double shift_rms_px = 0;                    // of the estimator alone
  double surface_rms_px = 0;                  // of a point anywhere on the ball, per axis
  double window_rms_px = 0, window_bound_px = 0, no_texture_share = 0, wrong_share = 0;
  double bound_px = 0, bound_deg = 0;
};
PooledErrors pool(std::span<const PatternStudyRow> rows, const std::string& pattern_prefix,
                  const std::string& estimator, double radius_px);

// Pooled errors by estimator, by group of patterns and by pattern; the best estimator and the best
// pattern; "finding", a sentence that says which pattern to paint.
nlohmann::json describe_patterns(std::span<const PatternStudyRow> rows,
                                 const PatternStudyOptions& options);

}  // namespace impactdic::study
