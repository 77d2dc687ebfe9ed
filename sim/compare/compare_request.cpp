#include <impactdic/compare.h>
#include <impactdic/error.h>

#include <algorithm>
#include <cmath>

#include "sim/fit/calibration.h"

namespace impactdic {
namespace {

constexpr std::string_view kKelvinVoigt = "kelvin_voigt";

void require(bool good, const std::string& what, const char* key, const char* hint = "") {
  if (!good) throw InvalidArgument(what, key, hint);
}

}  // namespace

std::string_view name_of(const ComparedModel& model) {
  if (const auto* friction = std::get_if<FrictionModel>(&model)) return name_of(*friction);
  if (const auto* rebound = std::get_if<ReboundModel>(&model)) return name_of(*rebound);
  return kKelvinVoigt;
}

ComparedModel parse_compared_model(std::string_view name) {
  if (name == kKelvinVoigt) return KelvinVoigt{};
  if (is_rebound_model(name)) return parse_rebound_model(name);
  try {
    return parse_friction_model(name);
  } catch (const InvalidArgument& error) {
    throw InvalidArgument(error.what(), error.where(),
                          error.hint() + ", kelvin_voigt, garwin, cross, walton, stronge");
  }
}

void CompareRequest::validate() const {
  require(!shots.empty() || !tables.empty(), "no tracks are named", "tracks",
          "or name tables of shots under shots");
  require(!models.empty(), "no models are named", "models");
  for (const FitShot& shot : shots) {
    if (shot.in_memory) shot.in_memory->validate();
  }
  require(std::isnan(formula.restitution) || (formula.restitution >= 0 && formula.restitution <= 1),
          "must be from 0 to 1", "formula.restitution");
  require(std::abs(formula.tangential_restitution) <= 1, "must be from -1 to 1",
          "formula.tangential_restitution");
  require(threads >= 0, "must not be negative", "threads");
  if (!calibration.shots.empty()) return calibration.validate();
  // Nothing is fitted: the laws alone must be possible.
  FitRequest laws = calibration;
  laws.parameters.clear();
  laws.method = FitMethod::kTrajectory;
  sim::fit::validate_settings(laws);
}

void RodCompareRequest::validate() const {
  require(!models.empty(), "no models are named", "models");
  const auto wanted = [this](std::string_view model) {
    return std::find(models.begin(), models.end(), model) != models.end();
  };
  for (const std::string& model : models) {
    require(model == "rigid_rod" || model == "flexible_rod" || model == "stronge",
            "'" + model + "' is no model of a rod", "models",
            "one of rigid_rod, flexible_rod, stronge");
  }
  require(!tables.empty(), "no tables of shots are named", "shots");
  require(!wanted("stronge") || (energetic_restitution >= 0 && energetic_restitution <= 1),
          "must be from 0 to 1", "formula.restitution");
  require(threads >= 0, "must not be negative", "threads");
  for (const RodModel* model : {&rigid, &flexible}) {
    if (model == &flexible && !wanted("flexible_rod")) continue;
    RodJob probe = model->rod;  // the blows bring their own motion
    probe.angle_rad = 1, probe.vt_m_s = probe.omega_rad_s = 0, probe.vn_m_s = -1;
    probe.validate();
  }
}

}  // namespace impactdic
