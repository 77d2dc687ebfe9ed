// The speckle study of the dissertation's section 2.3: painted balls, motions that are
// exactly known, and the errors with which estimators measure them.
#pragma once

#include <impactdic/study.h>

#include <vector>

namespace impactdic::opencl {
class Engine;
}  // namespace impactdic::opencl

namespace impactdic::study {

// Runs the study on a device; of a cancelled run the clips that were done.
std::vector<PatternStudyRow> run_pattern_study(opencl::Engine& engine,
                                               const PatternStudyRequest& request,
                                               const RunControl& control = {});

}  // namespace impactdic::study
