// A straight edge between ball and background as a camera and the lines' samples see it. Internal
// to host/circle.
#pragma once

#include <Eigen/Dense>

#include "host/circle/rim/rim_lines.h"

namespace impactdic::circle {

// One figure for each sample of a line.
using SampleVector = Eigen::Matrix<double, kSamples, 1>;
using SampleMatrix = Eigen::Matrix<double, kSamples, kSamples>;

// How much of each sample is ball, 0 … 1, and its derivatives with respect to the edge's place
// (steps of the trace) and to ln σ.
struct BlurredEdge {
  SampleVector level, shift, wider;
};

// An edge `excess` steps outside the middle sample, blurred by a Gaussian of `sigma` steps and by
// the kernel of the samples' interpolation (Catmull and Rom's cubic) of which `kernel` steps are
// one pixel along the normal: the cubic blurs by its fourth moment.
BlurredEdge blurred_edge(double excess, double sigma, double kernel);

}  // namespace impactdic::circle
