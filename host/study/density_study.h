// Figures 2.1 and 2.2 of the dissertation: time and error against the number of spline points
// between pixels, for the published method as it is described, for the same by our route, and for
// the default method, which has no such number.
#pragma once

#include <impactdic/study.h>

#include <span>

namespace impactdic::opencl {
class Engine;
}  // namespace impactdic::opencl

namespace impactdic::study {

// Rows and windows; the findings are left out. Of a cancelled run the rows that were done.
DensityStudyResult run_density_study(opencl::Engine& engine, const DensityStudyRequest& request,
                                     const RunControl& control = {});

// What rows of all three methods say. There must be some of each.
DensityFindings find_density(std::span<const DensityRow> rows, int window_px);

}  // namespace impactdic::study
