// What a fit to lines across a rim tells: its corrections, their covariance, and what the lines say
// at them. Internal to host/circle.
#pragma once

#include "host/circle/rim/line_sums.h"
#include "host/circle/rim/rim_lines.h"
#include "host/circle/rim/rim_prior.h"

namespace impactdic::circle {

// One fit: corrections to the rim, their covariance, and what the lines say.
struct LineEstimate {
  bool ok = false;
  Shape shape = Shape::kCircle;
  Vector5 delta = Vector5::Zero();
  Matrix5 covariance = Matrix5::Zero();
  Matrix5 misplaced = Matrix5::Zero();  // covariance that a place_sd_px of 1 px adds
  RadiusOfFrame own;
  double wider = 1, scatter = 0;  // see inflation; of the bare lines
  int points = 0;
  double arc = 0;
  double oval = 0;  // of a circle: χ² that its lines hold against it, 2 degrees of freedom
  // What the next estimate can start from: the shares of the kinds over those inside the ball, the
  // corrections about which the evidence in the workspace is linear, and the last sums.
  KindShares shares{};
  Vector5 about = Vector5::Zero(), summed_at = Vector5::Zero();
  LineSums sums;
};

// From the sums, which lie at most a step before the fit, at `delta`: its covariance and what the
// lines say. `known`: as the last step took it. The caller fills in the points.
void describe(const Rim& rim, const Vector5& delta, const Knowledge& known, double step_px,
              LineEstimate& estimate);

// Whether an ellipse is more than what noise and the model make of circles.
bool is_plainly_oval(const Rim& rim, const LineEstimate& oval, const RimModel& model);

// The fit about `rim`, as of a flat ball, without the width's part.
LineFit fit_of(const LineEstimate& best, const Rim& rim);

}  // namespace impactdic::circle
