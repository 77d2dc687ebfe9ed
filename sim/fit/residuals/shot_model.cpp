#include "sim/fit/residuals/shot_model.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/contact/impact.h"

namespace impactdic::sim::fit {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Below these a stated deviation is rounding, not noise.
constexpr double kLeastPosition_sd_m = 1e-10, kLeastTurn_sd_rad = 1e-9;

// Of two springs in series one that is so many times stiffer than at the start, where they share
// the way, is rigid.
constexpr double kRigid = 20;

// A residual of so many deviations is not noise.
constexpr double kFarOff = 4;

bool is_law(FitParameter p) {
  return p != FitParameter::kContactTime && p != FitParameter::kSurfaceAngle &&
         p != FitParameter::kScale && p != FitParameter::kRate;
}

bool is_air(FitParameter p) { return p == FitParameter::kDrag || p == FitParameter::kLift; }

double upper_bound(FitParameter p) {
  switch (p) {
    case FitParameter::kPoisson:
      return 0.5;
    case FitParameter::kFlatFraction:
      return 0.999;
    case FitParameter::kFrictionKinetic:
    case FitParameter::kFrictionStatic:
    case FitParameter::kDrag:
    case FitParameter::kLift:
      return 10;
    default:
      return kInfinity;
  }
}

}  // namespace

ShotModel::ShotModel(const MeasuredTrack& track, const MeasuredShot& shot, const ImpactJob& laws,
                     const std::vector<FitParameter>& parameters,
                     const std::vector<FitParameter>& unknowns)
    : laws_(laws), shot_(shot), interval_s_(track.interval_s) {
  has_spin_ = !std::isnan(shot.before.omega_rad_s.value);
  build_rows(track, shot);
  add_unknowns(shot, parameters, unknowns);
  add_known(FitParameter::kScale, track.scale_sd);
  add_known(FitParameter::kRate, track.rate_sd);
  if (residuals_ <= unknowns_.size()) {
    throw FormatError(shot.file, -1, "the track has fewer measurements than there are unknowns");
  }
}

void ShotModel::build_rows(const MeasuredTrack& track, const MeasuredShot& shot) {
  const std::size_t first = shot.before.first, last = shot.after.last;
  const auto sd_or = [](double sd, double otherwise, double least) {
    return std::max(std::isnan(sd) ? otherwise : sd, least);
  };
  for (std::size_t i = first; i <= last; ++i) {
    const std::size_t at = i - first;
    time_s_.push_back(track.time_s[i]);
    const double sd = sd_or(track.position_sd_m[i], shot.noise_m, kLeastPosition_sd_m);
    if (!std::isnan(track.x_m[i]) && !std::isnan(track.y_m[i])) {
      rows_.push_back({Row::Kind::kX, at, track.x_m[i], sd});
      rows_.push_back({Row::Kind::kY, at, track.y_m[i], sd});
    }
    if (i == last) continue;
    // A motion without its own deviation cannot be weighed against the centres: left out.
    if (!std::isnan(track.dx_m[i]) && !std::isnan(track.motion_sd_m[i])) {
      const double motion_sd = std::max(track.motion_sd_m[i], kLeastPosition_sd_m);
      rows_.push_back({Row::Kind::kDx, at, track.dx_m[i], motion_sd});
      rows_.push_back({Row::Kind::kDy, at, track.dy_m[i], motion_sd});
    }
    if (has_spin_ && !std::isnan(track.turn_rad[i]) && !std::isnan(track.turn_sd_rad[i])) {
      rows_.push_back({Row::Kind::kTurn, at, track.turn_rad[i],
                       std::max(track.turn_sd_rad[i], kLeastTurn_sd_rad)});
    }
  }
  has_spin_ = std::any_of(rows_.begin(), rows_.end(),
                          [](const Row& row) { return row.kind == Row::Kind::kTurn; });
  residuals_ = rows_.size();
}

void ShotModel::add_unknowns(const MeasuredShot& shot, const std::vector<FitParameter>& parameters,
                             const std::vector<FitParameter>& unknowns) {
  const double speed = std::abs(shot.before.vn_m_s.value);
  for (FitParameter p : parameters) {
    const double start = law_parameter(laws_, p);
    const bool damps = p == FitParameter::kDamping || p == FitParameter::kShellDamping;
    const double least = damps ? 0.1 : is_air(p) ? 10 : 1e-2;
    const double step = 1e-4 * std::max(std::abs(start), least);
    const bool stiff = p == FitParameter::kStiffness || p == FitParameter::kYieldStrength ||
                       p == FitParameter::kShellStiffness || p == FitParameter::kFlatFraction;
    const double lower = p == FitParameter::kLift ? -upper_bound(p) : stiff ? 1e-6 * start : 0.0;
    const bool in_series =
        laws_.shell && (p == FitParameter::kStiffness || p == FitParameter::kShellStiffness);
    const double upper = in_series ? kRigid * start : upper_bound(p);
    unknowns_.push_back({Unknown::Kind::kParameter, p, start, step, lower, upper});
  }
  for (FitParameter p : unknowns) {
    const double span = time_s_.back() - time_s_.front();
    if (p == FitParameter::kContactTime) {
      const double start = shot.contact_start_s.value;
      unknowns_.push_back({Unknown::Kind::kParameter, p, start, 1e-3 * interval_s_,
                           start - span / 4, start + span / 4});
    } else if (p == FitParameter::kSurfaceAngle) {
      unknowns_.push_back({Unknown::Kind::kParameter, p, shot.surface_angle_deg, 1e-2,
                           shot.surface_angle_deg - 45, shot.surface_angle_deg + 45});
    } else {
      unknowns_.push_back({Unknown::Kind::kParameter, p, 1, 1e-4, 0.5, 2});
    }
  }
  const auto motion = [&](Unknown::Kind kind, double start, double step) {
    unknowns_.push_back({kind, {}, start, step, -kInfinity, kInfinity});
  };
  motion(Unknown::Kind::kTouchX, shot.touch_x_m, 1e-6);
  motion(Unknown::Kind::kTouchY, shot.touch_y_m, 1e-6);
  motion(Unknown::Kind::kTangentialVelocity, shot.before.vt_m_s.value, 1e-4 * speed);
  motion(Unknown::Kind::kNormalVelocity, shot.before.vn_m_s.value, 1e-4 * speed);
  if (has_spin_) {
    motion(Unknown::Kind::kSpin, shot.before.omega_rad_s.value,
           1e-4 * speed / laws_.body.radius_m());
  }
}

std::size_t ShotModel::place_of(FitParameter parameter) const {
  for (std::size_t i = 0; i < unknowns_.size(); ++i) {
    if (unknowns_[i].kind == Unknown::Kind::kParameter && unknowns_[i].parameter == parameter) {
      return i;
    }
  }
  return unknowns_.size();
}

void ShotModel::add_known(FitParameter parameter, double sd) {
  if (!(sd > 0) || place_of(parameter) < unknowns_.size()) return;
  rows_.push_back({Row::Kind::kPrior, unknowns_.size(), 1, sd});
  unknowns_.push_back({Unknown::Kind::kParameter, parameter, 1, 1e-4, 0.5, 2});
  residuals_ = rows_.size();
}

double ShotModel::value_or(FitParameter parameter, const double* values, double otherwise) const {
  const std::size_t place = place_of(parameter);
  return place < unknowns_.size() ? values[place] : otherwise;
}

ImpactJob ShotModel::impact_of(const double* values) const {
  ImpactJob laws = laws_;
  for (std::size_t i = 0; i < unknowns_.size(); ++i) {
    const Unknown& u = unknowns_[i];
    if (u.kind == Unknown::Kind::kParameter && is_law(u.parameter)) {
      set_law_parameter(laws, u.parameter, values[i]);
    }
  }
  ImpactJob job = job_of_shot(laws, shot_);
  job.surface_angle_deg = value_or(FitParameter::kSurfaceAngle, values, shot_.surface_angle_deg);
  for (std::size_t i = 0; i < unknowns_.size(); ++i) {
    switch (unknowns_[i].kind) {
      case Unknown::Kind::kTangentialVelocity:
        job.initial.vt_m_s = values[i];
        break;
      case Unknown::Kind::kNormalVelocity:
        job.initial.vn_m_s = values[i];
        break;
      case Unknown::Kind::kSpin:
        job.initial.omega_rad_s = values[i];
        break;
      default:
        break;
    }
  }
  return job;
}

std::vector<double> ShotModel::instants(const double* values) const {
  const double start = value_or(FitParameter::kContactTime, values, shot_.contact_start_s.value);
  const double rate = value_or(FitParameter::kRate, values, 1);
  std::vector<double> times(time_s_);
  for (double& time : times) time = (time - start) * rate;
  return times;
}

bool ShotModel::predict(const double* values, Prediction& p) const {
  const ImpactJob job = impact_of(values);
  const std::vector<double> times = instants(values);
  ImpactResult impact;
  try {
    impact = contact::simulate_impact(job, {0, times});
  } catch (const Error&) {
    return false;  // these values have no impact: the solver must step back
  }
  if (!impact.separated || impact.trajectory.size() != times.size()) return false;
  double x = 0, y = 0;
  for (std::size_t i = 0; i < unknowns_.size(); ++i) {
    if (unknowns_[i].kind == Unknown::Kind::kTouchX) x = values[i];
    if (unknowns_[i].kind == Unknown::Kind::kTouchY) y = values[i];
  }
  const double angle = job.surface_angle_deg * kRadPerDeg;
  const double c = std::cos(angle), s = std::sin(angle);
  for (auto* v : {&p.x, &p.y, &p.angle, &p.vx, &p.vy, &p.spin}) v->resize(times.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    const BodyState& state = impact.trajectory[i].state;
    // The camera sees the outline.
    const double qn = state.qn_m - state.outline_lag_m;
    const double vn = state.vn_m_s - state.outline_lag_rate_m_s;
    p.x[i] = x + c * state.qt_m - s * qn;
    p.y[i] = y + s * state.qt_m + c * qn;
    p.vx[i] = c * state.vt_m_s - s * vn;
    p.vy[i] = s * state.vt_m_s + c * vn;
    p.angle[i] = state.angle_rad;
    p.spin[i] = state.omega_rad_s;
  }
  p.trajectory = std::move(impact.trajectory);
  return true;
}

MeasurementSeries ShotModel::series_of(std::size_t row) const {
  switch (rows_[row].kind) {
    case Row::Kind::kX:
      return {MeasurementKind::kCentre, 0};
    case Row::Kind::kY:
      return {MeasurementKind::kCentre, 1};
    case Row::Kind::kDx:
      return {MeasurementKind::kMotion, 0};
    case Row::Kind::kDy:
      return {MeasurementKind::kMotion, 1};
    case Row::Kind::kPrior:
      return {MeasurementKind::kPrior, rows_[row].frame};
    default:
      return {MeasurementKind::kTurn, 0};
  }
}

void ShotModel::weigh(const DeviationFactors& factors, std::span<const double> stated_residuals) {
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    if (rows_[r].kind == Row::Kind::kPrior) continue;
    const double factor = factors[static_cast<std::size_t>(series_of(r).kind)];
    const double off = stated_residuals.empty() ? 0 : std::abs(stated_residuals[r]) / factor;
    rows_[r].sd = rows_[r].stated_sd * factor * std::sqrt(std::max(1.0, off / kFarOff));
  }
}

double ShotModel::predicted(const Row& row, const Path& p, const double* values) const {
  const std::size_t i = row.frame;
  switch (row.kind) {
    case Row::Kind::kX:
      return p.x[i];
    case Row::Kind::kY:
      return p.y[i];
    case Row::Kind::kDx:
      return p.x[i + 1] - p.x[i];
    case Row::Kind::kDy:
      return p.y[i + 1] - p.y[i];
    case Row::Kind::kTurn:
      return p.angle[i + 1] - p.angle[i];
    case Row::Kind::kPrior:
      return values[i];
  }
  return 0;
}

bool ShotModel::is_length(const Row& row) {
  return row.kind != Row::Kind::kTurn && row.kind != Row::Kind::kPrior;
}

// The model's lengths are divided by the scale, not the measured ones multiplied: their deviations
// are those of the table, and a smaller scale must not shrink what the model leaves.
double ShotModel::as_measured(const Row& row, double model, const double* values) const {
  return is_length(row) ? model / value_or(FitParameter::kScale, values, 1) : model;
}

bool ShotModel::evaluate(const double* values, double* residual, double* jacobian) const {
  Prediction here;
  if (!predict(values, here)) return false;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const Row& row = rows_[r];
    residual[r] = (as_measured(row, predicted(row, here, values), values) - row.measured) / row.sd;
  }
  return jacobian == nullptr || fill_jacobian(values, here, jacobian);
}

double ShotModel::path_rms_m(const double* values) const {
  Prediction here;
  if (!predict(values, here)) return kNotMeasured;
  const double scale = value_or(FitParameter::kScale, values, 1);
  double sum = 0, count = 0;
  for (const Row& row : rows_) {
    if (row.kind != Row::Kind::kX && row.kind != Row::Kind::kY) continue;
    const double off = predicted(row, here, values) - scale * row.measured;
    sum += off * off, ++count;
  }
  return std::sqrt(sum / count);
}

std::vector<FitResidual> ShotModel::residuals_at(const double* values) const {
  std::vector<FitResidual> list;
  Prediction here;
  if (!predict(values, here)) return list;
  const double scale = value_or(FitParameter::kScale, values, 1);
  for (const Row& row : rows_) {
    if (row.kind == Row::Kind::kPrior) continue;
    const double measured = is_length(row) ? scale * row.measured : row.measured;
    list.push_back({static_cast<FitResidual::Series>(row.kind), time_s_[row.frame],
                    predicted(row, here, values) - measured, row.stated_sd});
  }
  std::stable_sort(list.begin(), list.end(),
                   [](const FitResidual& a, const FitResidual& b) { return a.series < b.series; });
  return list;
}

}  // namespace impactdic::sim::fit
