#include "host/impact/impact_series.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "host/clip/centre_on_body.h"
#include "host/clip/track_row.h"

namespace impactdic::impact {
namespace {

using Vector4 = Eigen::Vector4d;  // dx, dy, turns about X and Y: px, px, rad, rad; y down
using Matrix4 = Eigen::Matrix4d;

Matrix4 stated_covariance(const TrackRow& row) {
  const double rx = row.rot_x_sd_deg * kRadPerDeg, ry = row.rot_y_sd_deg * kRadPerDeg;
  Matrix4 covariance = Vector4(row.dx_sd_px, row.dy_sd_px, rx, ry).cwiseAbs2().asDiagonal();
  covariance(0, 3) = covariance(3, 0) = row.dx_rot_y_corr * row.dx_sd_px * ry;
  covariance(1, 2) = covariance(2, 1) = row.dy_rot_x_corr * row.dy_sd_px * rx;
  return covariance;
}

// Less what an error of the radius, or of the distance, is a part of: `effect` by one deviation. It
// moves all four together; a row keeps no more than stated_covariance does. Rows that have no such
// part are left as they are.
Matrix4 without(const Matrix4& stated, const Vector4& effect) {
  constexpr double kLeft = 1e-4;  // of each variance
  Matrix4 shared = effect * effect.transpose();
  shared(0, 1) = shared(1, 0) = shared(0, 2) = shared(2, 0) = 0;
  shared(1, 3) = shared(3, 1) = shared(2, 3) = shared(3, 2) = 0;
  const Matrix4 own = stated - shared;
  const Vector4 scale = stated.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix4 unit = scale.asDiagonal() * own * scale.asDiagonal();
  const bool is_covariance = unit.diagonal().minCoeff() > kLeft &&
                             Eigen::SelfAdjointEigenSolver<Matrix4>(unit).eigenvalues()[0] > 1e-6;
  return is_covariance ? own : stated;
}

bool has_motion(const TrackRow& row) {
  return row.motion_ok && row.status != TrackStatus::kInconsistent;
}

}  // namespace

SphereSteps::SphereSteps(const TrackRows& rows, double surface_angle_rad, const SphereKnown& known)
    : rows_(rows),
      c_(std::cos(surface_angle_rad)),
      s_(std::sin(surface_angle_rad)),
      radius_px_(median_radius_px(rows).value_or(kNotMeasured)),
      known_(known) {}

sphere::SourceResponse SphereSteps::response(const TrackRow& row, const Eigen::Vector3d& turn,
                                             double dx_px, double dy_px) const {
  const std::array<double, 2> aside = {row.cx_px - known_.axis_px[0],
                                       row.cy_px - known_.axis_px[1]};
  return sphere::source_response(
      {{turn.x(), turn.y(), turn.z()}, radius_px_, aside, {aside[0] + dx_px, aside[1] + dy_px}});
}

SphereStep SphereSteps::operator[](std::size_t i) const {
  const TrackRow& row = rows_[i];
  SphereStep step;
  if (!has_motion(row) || !std::isfinite(row.rot_x_deg)) return step;
  const Eigen::Vector3d turn =
      Eigen::Vector3d(row.rot_x_deg, row.rot_y_deg, row.rot_deg) * kRadPerDeg;
  const auto response = this->response(row, turn, row.dx_px, row.dy_px);
  const auto by = [&](std::size_t source) {
    return Vector4(response.dx[source], response.dy[source], response.rot_x[source],
                   response.rot_y[source]);
  };
  const Vector4 to_radius = by(sphere::kToRadius), to_nearness = by(sphere::kToNearness);
  const Matrix4 own =
      without(without(stated_covariance(row), known_.radius_sd_px.value_or(0) * to_radius),
              known_.nearness_sd * to_nearness);
  Matrix4 local = Matrix4::Zero();  // to step t, n and turn t, n; steps have y down
  local.topLeftCorner<2, 2>() << c_, -s_, -s_, -c_;
  local.bottomRightCorner<2, 2>() << c_, s_, -s_, c_;
  const Matrix4 covariance = local * own * local.transpose();
  const Vector4 radius = local * to_radius, nearness = local * to_nearness;
  const Eigen::Matrix2d steps = covariance.topLeftCorner<2, 2>();
  const Eigen::Matrix2d by_step = covariance.bottomLeftCorner<2, 2>() * steps.inverse();
  const Eigen::Matrix2d rest =
      covariance.bottomRightCorner<2, 2>() - by_step * covariance.topRightCorner<2, 2>();
  if (!by_step.allFinite() || !(rest.diagonal().minCoeff() > 0)) return step;
  step.ok = true;
  for (int k = 0; k < 2; ++k) {
    const auto at = static_cast<std::size_t>(k);
    step.turn[at] = k == 0 ? c_ * turn.x() + s_ * turn.y() : -s_ * turn.x() + c_ * turn.y();
    step.step_sd[at] = std::sqrt(steps(k, k));
    step.turn_sd[at] = std::sqrt(rest(k, k));
    step.by_step[at] = {by_step(k, 0), by_step(k, 1)};
    step.step_to_radius[at] = radius[k];
    step.turn_to_radius[at] = radius[2 + k];
    step.step_to_nearness[at] = nearness[k];
    step.turn_to_nearness[at] = nearness[2 + k];
  }
  step.roll_to_nearness = response.rot_z[sphere::kToNearness];
  return step;
}

double common_share(double scatter, std::size_t count) {
  const double chance = 3 * std::sqrt(2 / static_cast<double>(count));
  return std::max(0.0, 1 - scatter * scatter - chance);
}

ImpactSeries::ImpactSeries(const TrackRows& rows, double surface_angle_rad,
                           const SphereKnown& known)
    : rows_(rows), c_(std::cos(surface_angle_rad)), s_(std::sin(surface_angle_rad)) {
  position_n.reserve(rows.size());
  step_n.reserve(rows.size());
  bool any_motion = false, any_turn = false;
  CentreOnBody centre;
  is_elsewhere_.reserve(rows.size());
  for (const TrackRow& row : rows) {
    is_elsewhere_.push_back(centre.compare(row).elsewhere);
    const bool motion = has_motion(row, position_n.size());
    any_motion |= motion;
    any_turn |= motion && std::isfinite(row.rot_x_deg);
    // Image axes have y down.
    const RimCentre rim = rim_centre(row);
    position_n.push_back(has_place(row, position_n.size()) ? local(rim.x_px, rim.y_px)[1]
                                                           : kNotMeasured);
    step_n.push_back(motion ? -s_ * row.dx_px - c_ * row.dy_px : kNotMeasured);
  }
  if (any_turn) sphere.emplace(rows, surface_angle_rad, known);
  if (!any_motion) use_centres();
}

void ImpactSeries::use_centres() {
  from_circle = true;
  sphere.reset();  // whose turns come with its steps
  for (std::size_t i = 0; i + 1 < size(); ++i) step_n[i] = position_n[i + 1] - position_n[i];
}

bool ImpactSeries::has_place(const TrackRow& row, std::size_t i) const {
  return row.circle_ok && !is_elsewhere_[i];
}

bool ImpactSeries::has_motion(const TrackRow& row, std::size_t i) const {
  const bool circle_errs = is_elsewhere_[i] && !std::isfinite(row.rot_x_deg);
  return row.motion_ok && (circle_errs || impact::has_motion(row));
}

bool ImpactSeries::is_motion_lost(std::size_t first, std::size_t last) const {
  std::size_t lost = 0;
  for (std::size_t i = first; i < last; ++i) lost += has_motion(rows_[i], i) ? 0 : 1;
  return 2 * lost > last - first;
}

double ImpactSeries::position_t(std::size_t i) const {
  const TrackRow row = rows_[i];
  const RimCentre rim = rim_centre(row);
  return has_place(row, i) ? local(rim.x_px, rim.y_px)[0] : kNotMeasured;
}

double ImpactSeries::position_sd(std::size_t i) const {
  const RimCentre rim = rim_centre(rows_[i]);
  return std::hypot(rim.x_sd_px, rim.y_sd_px) / std::sqrt(2.0);
}

std::array<double, 2> ImpactSeries::rim_off(std::size_t first, std::size_t last) const {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int count = 0;
  for (std::size_t i = first; i <= last; ++i) {
    const TrackRow row = rows_[i];
    if (!std::isfinite(row.rim_off_x_px)) continue;
    sum += Eigen::Vector2d(row.rim_off_x_px, row.rim_off_y_px);
    ++count;
  }
  const Eigen::Vector2d off = sum / std::max(count, 1);
  return local(off.x(), off.y());
}

double ImpactSeries::step_t(std::size_t i) const {
  if (from_circle && i + 1 < size()) return position_t(i + 1) - position_t(i);
  const TrackRow row = rows_[i];
  return has_motion(row, i) ? c_ * row.dx_px - s_ * row.dy_px : kNotMeasured;
}

double ImpactSeries::step_sd(std::size_t i) const {
  if (from_circle && i + 1 < size()) return std::hypot(position_sd(i), position_sd(i + 1));
  const TrackRow row = rows_[i];
  return std::hypot(row.dx_sd_px, row.dy_sd_px) / std::sqrt(2.0);
}

double ImpactSeries::origin_sd(std::size_t i) const {
  const std::optional<std::size_t> at = rows_.find_frame(rows_[i].pose.origin);
  return at && *at <= i ? position_sd(*at) : kNotMeasured;
}

double ImpactSeries::turn(std::size_t i) const {
  const TrackRow row = rows_[i];
  return has_motion(row, i) ? row.rot_deg * kRadPerDeg : kNotMeasured;
}

double ImpactSeries::turn_sd(std::size_t i) const { return rows_[i].rot_sd_deg * kRadPerDeg; }

}  // namespace impactdic::impact
