// Derivatives of ShotModel's residuals.
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "sim/contact/derivatives/path_slopes.h"
#include "sim/contact/impact.h"
#include "sim/fit/residuals/shot_model.h"

namespace impactdic::sim::fit {
namespace {

// As in a job file.
std::string number_of(const Unknown& unknown, NormalModel law) {
  switch (unknown.kind) {
    case Unknown::Kind::kTangentialVelocity:
      return "initial.vt_m_s";
    case Unknown::Kind::kNormalVelocity:
      return "initial.vn_m_s";
    case Unknown::Kind::kSpin:
      return "initial.omega_rad_s";
    default:
      break;
  }
  switch (unknown.parameter) {
    case FitParameter::kSurfaceAngle:
      return "surface.angle_deg";
    case FitParameter::kDrag:
    case FitParameter::kLift:
      return "air." + key_of(unknown.parameter, law);
    case FitParameter::kShellStiffness:
      return "shell.stiffness_n_per_m";
    case FitParameter::kShellDamping:
      return "shell.damping_n_s_per_m";
    case FitParameter::kFlatFraction:
      return "shell.flat_fraction";
    default:
      return "contact." + key_of(unknown.parameter, law);
  }
}

}  // namespace

// By the contact's start or by the rate, which only move the instants: the velocities are its
// derivatives, through the events as well.
ShotModel::Path ShotModel::slope_in_time(FitParameter parameter, const double* values,
                                         const Prediction& here) const {
  const double start = value_or(FitParameter::kContactTime, values, shot_.contact_start_s.value);
  const double rate = value_or(FitParameter::kRate, values, 1);
  Path slope{here.vx, here.vy, here.spin};
  for (std::size_t i = 0; i < time_s_.size(); ++i) {
    const double moves = parameter == FitParameter::kRate ? time_s_[i] - start : -rate;
    slope.x[i] *= moves, slope.y[i] *= moves, slope.angle[i] *= moves;
  }
  return slope;
}

// Of the unknowns that do not change the motion about the touch; nothing of the others.
std::optional<ShotModel::Path> ShotModel::slope_in_closed_form(const Unknown& unknown,
                                                               const double* values,
                                                               const Prediction& here) const {
  const std::size_t frames = time_s_.size();
  const std::vector<double> zero(frames, 0.0), one(frames, 1.0);
  if (unknown.kind == Unknown::Kind::kTouchX) return Path{one, zero, zero};
  if (unknown.kind == Unknown::Kind::kTouchY) return Path{zero, one, zero};
  if (unknown.kind != Unknown::Kind::kParameter) return std::nullopt;
  if (unknown.parameter == FitParameter::kScale) {
    const double scale = value_or(FitParameter::kScale, values, 1);
    Path slope{here.x, here.y, zero};
    for (double& x : slope.x) x /= -scale;
    for (double& y : slope.y) y /= -scale;
    return slope;
  }
  const bool in_time =
      unknown.parameter == FitParameter::kContactTime || unknown.parameter == FitParameter::kRate;
  return in_time ? std::optional(slope_in_time(unknown.parameter, values, here)) : std::nullopt;
}

std::vector<ShotModel::Path> ShotModel::slopes_of_motion(std::span<const std::size_t> places,
                                                         const double* values,
                                                         const Prediction& here) const {
  const ImpactJob job = impact_of(values);
  std::vector<std::string> keys;
  for (const std::size_t place : places) {
    keys.push_back(number_of(unknowns_[place], laws_.normal));
  }
  const auto found = contact::path_slopes(job, instants(values), keys, here.trajectory);
  if (!found) return {};
  const double angle = job.surface_angle_deg * kRadPerDeg;
  const double c = std::cos(angle), s = std::sin(angle);
  std::vector<Path> slopes(places.size());
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Unknown& unknown = unknowns_[places[k]];
    // The surface's angle also turns the whole path about the touch.
    const bool turns = unknown.kind == Unknown::Kind::kParameter &&
                       unknown.parameter == FitParameter::kSurfaceAngle;
    for (std::size_t i = 0; i < time_s_.size(); ++i) {
      const std::size_t at = i * places.size() + k;
      double t = found->t[at], n = found->n[at];
      if (turns) {
        const BodyState& state = here.trajectory[i].state;
        t -= kRadPerDeg * (state.qn_m - state.outline_lag_m);
        n += kRadPerDeg * state.qt_m;
      }
      slopes[k].x.push_back(c * t - s * n);
      slopes[k].y.push_back(s * t + c * n);
      slopes[k].angle.push_back(found->angle[at]);
    }
  }
  return slopes;
}

// Central differences, one-sided at a bound. False where the model has no impact there.
bool ShotModel::slope_by_differences(std::size_t place, const double* values, Path& slope) const {
  const Unknown& unknown = unknowns_[place];
  std::vector<double> moved(values, values + size());
  const double up = std::min(values[place] + unknown.step, unknown.upper);
  const double down = std::max(values[place] - unknown.step, unknown.lower);
  Prediction high, low;
  moved[place] = up;
  if (!predict(moved.data(), high)) return false;
  moved[place] = down;
  if (!predict(moved.data(), low)) return false;
  for (std::size_t i = 0; i < time_s_.size(); ++i) {
    slope.x.push_back((high.x[i] - low.x[i]) / (up - down));
    slope.y.push_back((high.y[i] - low.y[i]) / (up - down));
    slope.angle.push_back((high.angle[i] - low.angle[i]) / (up - down));
  }
  return true;
}

bool ShotModel::fill_jacobian(const double* values, const Prediction& here,
                              double* jacobian) const {
  std::vector<Path> slopes(size());
  std::vector<std::size_t> open;
  for (std::size_t u = 0; u < size(); ++u) {
    if (auto slope = slope_in_closed_form(unknowns_[u], values, here)) {
      slopes[u] = std::move(*slope);
    } else {
      open.push_back(u);
    }
  }
  std::vector<Path> found = slopes_of_motion(open, values, here);
  for (std::size_t k = 0; k < open.size(); ++k) {
    if (!found.empty()) {
      slopes[open[k]] = std::move(found[k]);
    } else if (!slope_by_differences(open[k], values, slopes[open[k]])) {
      return false;
    }
  }
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const Row& row = rows_[r];
    for (std::size_t u = 0; u < size(); ++u) {
      const double slope = row.kind == Row::Kind::kPrior
                               ? (row.frame == u ? 1 : 0)
                               : as_measured(row, predicted(row, slopes[u], values), values);
      jacobian[r * size() + u] = slope / row.sd;
    }
  }
  return true;
}

}  // namespace impactdic::sim::fit
