// What the speckle study measures: motions and estimators by name.
#pragma once

#include <impactdic/study.h>

#include <string>
#include <vector>

#include "host/motion/motion_estimator.h"

namespace impactdic::study {

// The source's four motions, and four that lie on no grid of spline points: at whole pixels a
// method that takes its displacement from such a grid seems exact.
const std::vector<StudyMotion>& study_motions();

struct StudyEstimator {
  std::string name;
  motion::EstimatorOptions options;
  // Windows are looked for where the circle has moved to. The published method compares windows at
  // the same place, and is biased for it.
  bool aimed = true;
};

// published (5 spline points) or published0 … published9, zncc, icgn3, icgn5, icgn7, ring, ball.
// Throws InvalidArgument naming them.
StudyEstimator parse_study_estimator(const std::string& name);

}  // namespace impactdic::study
