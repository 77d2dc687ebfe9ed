// What the rows of the speckle study say.
#pragma once

#include <impactdic/study.h>

#include <span>
#include <string>

namespace impactdic::study {

// One estimator's rows of the patterns whose names begin so, pooled.
PooledErrors pool(std::span<const PatternStudyRow> rows, const std::string& pattern_prefix,
                  const std::string& estimator, double radius_px);

// Pooled errors by estimator, by group of patterns and by pattern; the best estimator and the best
// pattern; a sentence that says which pattern to paint. There must be a row.
PatternFindings find_patterns(std::span<const PatternStudyRow> rows, double radius_px);

}  // namespace impactdic::study
