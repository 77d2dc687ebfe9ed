// The derivatives of a shot's path by what a fit looks for.
#include <impactdic/error.h>
#include <impactdic/units.h>

#include <cmath>

#include "sim/contact/derivatives/derivatives.h"
#include "sim/fit/shot_model.h"

namespace impactdic::sim::fit {
namespace {

// The number of the job that the unknown is; empty where it is none.
std::string input_of(const Unknown& unknown, NormalModel normal) {
  switch (unknown.kind) {
    case Unknown::Kind::kTangentialVelocity:
      return "initial.vt_m_s";
    case Unknown::Kind::kNormalVelocity:
      return "initial.vn_m_s";
    case Unknown::Kind::kSpin:
      return "initial.omega_rad_s";
    case Unknown::Kind::kTouchX:
    case Unknown::Kind::kTouchY:
      return "";
    case Unknown::Kind::kParameter:
      break;
  }
  switch (unknown.parameter) {
    case FitParameter::kContactTime:
    case FitParameter::kScale:
    case FitParameter::kRate:
      return "";
    case FitParameter::kSurfaceAngle:
      return "surface.angle_deg";
    case FitParameter::kDrag:
      return "air.drag_coefficient";
    case FitParameter::kLift:
      return "air.lift_coefficient";
    default:
      return "contact." + key_of(unknown.parameter, normal);
  }
}

}  // namespace

std::vector<ShotModel::Prediction> ShotModel::exact_slopes(const double* values) const {
  std::vector<Prediction> slopes(size());
  const ImpactJob job = impact_of(values);
  std::vector<std::string> inputs;
  std::vector<std::size_t> places;
  for (std::size_t u = 0; u < size(); ++u) {
    const std::string input = input_of(unknowns_[u], job.normal);
    if (input.empty()) continue;
    inputs.push_back(input);
    places.push_back(u);
  }
  const std::vector<double> times = model_times(values);
  contact::SensitivePath path;
  try {
    path = contact::sensitive_path(job, times, inputs);
  } catch (const Error&) {
    return slopes;
  }
  if (!path.separated) return slopes;
  const double angle = job.surface_angle_deg * kRadPerDeg;
  const double c = std::cos(angle), s = std::sin(angle);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const double turn = inputs[i] == "surface.angle_deg" ? kRadPerDeg : 0;
    Prediction& slope = slopes[places[i]];
    for (std::size_t k = 0; k < times.size(); ++k) {
      const contact::ImpactState& x = path.states[k];
      const contact::ImpactState& dx = path.slopes[k * inputs.size() + i];
      const double t = x[contact::kQt], n = x[contact::kQn];
      const double dt = dx[contact::kQt] - turn * n, dn = dx[contact::kQn] + turn * t;
      if (!std::isfinite(dt + dn + dx[contact::kAngle])) {
        slope = {};
        break;
      }
      slope.x.push_back(c * dt - s * dn);
      slope.y.push_back(s * dt + c * dn);
      slope.angle.push_back(dx[contact::kAngle]);
    }
  }
  return slopes;
}

}  // namespace impactdic::sim::fit
