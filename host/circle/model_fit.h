// A rim by its rim model: followed from a model that is known, or learnt from a rim that is.
// Internal to host/circle.
#pragma once

#include <memory>

#include "host/circle/circle.h"
#include "host/circle/rim/rim.h"
#include "host/circle/rim/rim_lines.h"
#include "host/circle/rim/rim_model.h"

namespace impactdic::circle {

struct ModelFit {
  LineFit fit;  // not ok where the lines do not follow the model
  std::shared_ptr<const RimModel> rim_model;
  // In which it was learnt. A lamp may leave most of a ball's rim darker than the background.
  Polarity polarity = Polarity::kBright;
};

inline Shapes shapes_of(const CircleOptions& options) {
  return options.allow_ellipse ? Shapes::kCircleOrEllipse : Shapes::kCircle;
}

// How near the prior is.
enum class Approach {
  kAtOnce,        // to a small part of a step
  kAfterPreview,  // to a step or so: some lines and a rough fit come first
};
// With the prior's rim model, polarity and shape, which must be there.
ModelFit follow_rim(const Frame& frame, const CirclePrior& prior, const CircleOptions& options,
                    Approach approach, LineTrace& trace);

// Learns the model from a rim that is known already, and fits again. Not ok where the lines do not
// follow the model, or where it does not agree with what is known.
ModelFit learn_rim(const Frame& frame, const RimFit& known, const RimSearch& search,
                   const CirclePrior& prior, const CircleOptions& options, LineTrace& trace);

// How far two rims lie apart, px.
double distance(const Rim& a, const Rim& b);

}  // namespace impactdic::circle
