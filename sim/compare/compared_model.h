// The models that can be set against a measured shot of a ball.
#pragma once

#include <impactdic/compare.h>

namespace impactdic::sim::compare {

// The shot that `job` describes (laws, body, motion before, gravity) by the model. Throws
// InvalidArgument.
ModelPrediction predict_shot(const ComparedModel& model, const ImpactJob& job,
                             const FormulaParameters& formula);

}  // namespace impactdic::sim::compare
