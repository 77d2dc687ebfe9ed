// The speckle study of section 2.3 of Ghaednia's dissertation: painted balls, motions that are
// exactly known, and the errors with which estimators measure them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/base/progress.h"
#include "host/study/motion_errors.h"

namespace impactdic::opencl {
class Engine;
}  // namespace impactdic::opencl

namespace impactdic::study {

struct PatternStudyOptions {
  std::vector<std::string> patterns;  // empty: all sixteen
  std::vector<std::string> estimators = {"published", "zncc", "icgn3", "icgn5",
                                         "icgn7",     "ring", "ball"};
  double noise = 2;  // grey levels of 255
  std::uint64_t seed = 1;
  double radius_px = 115;
  int pairs = 4;          // of frames for each motion
  void validate() const;  // throws InvalidArgument
};

// One pattern, motion and estimator.
struct PatternStudyRow {
  std::string pattern, estimator;
  double density = 0;  // of the pattern
  StudyMotion motion;
  MotionErrors errors;
  ErrorSums centre_px;   // of the measured circle, both axes
  dic::BallBound bound;  // of the ball's motion, from all its pixels
};

// Runs the study. As `track` does, circles are measured in every frame, the first pair of a clip
// starts without knowing the rotation, the others know the first one's.
std::vector<PatternStudyRow> run_pattern_study(opencl::Engine& engine,
                                               const PatternStudyOptions& options,
                                               const ProgressFn& progress);

}  // namespace impactdic::study
