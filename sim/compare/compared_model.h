// The models that can be set against a measured shot of a ball.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "sim/contact/impact.h"
#include "sim/contact/rebound.h"

namespace impactdic::sim::compare {

struct KelvinVoigt {
  bool operator==(const KelvinVoigt&) const = default;
};
// A friction law beside the job's normal law; Kelvin and Voigt's normal law beside the job's
// friction; a formula.
using ComparedModel = std::variant<contact::FrictionModel, KelvinVoigt, contact::ReboundModel>;

std::string_view name_of(const ComparedModel& model);
// Throws InvalidArgument.
ComparedModel parse_compared_model(std::string_view name);

// What the formulas need beside the laws.
struct FormulaParameters {
  double restitution = 0;             // NaN: as the job's normal law gives it for the shot
  double tangential_restitution = 0;  // of cross (e_x) and walton (beta_0)
};

struct ModelPrediction {
  double restitution = 0;
  double vt_m_s = 0, vn_m_s = 0, omega_rad_s = 0;  // after
  double contact_s = 0, t_max_compression_s = 0;   // NaN: a formula has none
  std::vector<contact::Phase> phases;              // none of a formula
  std::optional<contact::ImpactJob> path;          // that was integrated
};

// The shot that `job` describes (laws, body, motion before, gravity) by the model. Throws
// InvalidArgument.
ModelPrediction predict_shot(const ComparedModel& model, const contact::ImpactJob& job,
                             const FormulaParameters& formula);

}  // namespace impactdic::sim::compare
