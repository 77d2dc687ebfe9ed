#include "host/run/camera/plane_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "host/camera/plane_field.h"
#include "host/camera/spread.h"
#include "host/dic/field.h"
#include "host/dic/rigid_fit.h"
#include "host/motion/field_motion.h"

namespace impactdic::run {
namespace {

using camera::PlaneField;
using Eigen::Vector2d;

// As in the picture: no window with a lucky residual outweighs the rest.
constexpr double kLeastSd_px = 0.002;

std::vector<Vector2d> centres_of(std::span<const Window> windows, int window_px) {
  const double half = (window_px - 1) / 2.0;
  std::vector<Vector2d> centres;
  for (const Window& window : windows) centres.emplace_back(window.x0 + half, window.y0 + half);
  return centres;
}

// The region as a camera beside the stated one would see it, on both sides.
struct RegionStep {
  PlaneField plus, minus;
  double deviations;
};

}  // namespace

class PlaneMotion::Impl {
 public:
  Impl(const Camera& camera, std::span<const Window> windows, const CorrelateRequest& request,
       const Roi& roi, int spacing_px)
      : window_px_(request.field.window_px),
        spacing_px_(spacing_px),
        by_region_(request.motion == RegionMotion::kRegion),
        metre_per_px_(camera::scale_at_middle(camera).value),
        centre_px_(roi.x + (roi.width - 1) / 2.0, roi.y + (roi.height - 1) / 2.0),
        windows_(camera, centres_of(windows, window_px_), metre_per_px_),
        region_(camera, points(roi), metre_per_px_) {
    for (const camera::CameraStep& step : camera::principal_steps(camera)) {
      steps_.push_back({PlaneField(step.plus, points(roi), metre_per_px_),
                        PlaneField(step.minus, points(roi), metre_per_px_), step.deviations});
    }
  }

  std::span<const PlaneResult> correct(std::span<const WindowMotion> field, MotionRow& row) {
    correct_windows(field);
    if (row.motion_ok) correct_row(row);
    return results_;
  }

 private:
  std::vector<Vector2d> points(const Roi& roi) const {
    return camera::points_of_region(centre_px_, roi.width, roi.height);
  }

  void correct_windows(std::span<const WindowMotion> field) {
    results_.assign(field.size(), {});
    for (std::size_t i = 0; i < field.size(); ++i) {
      const WindowMotion& motion = field[i];
      if (motion.status != static_cast<std::int32_t>(WindowStatus::kOk)) continue;
      Eigen::Matrix2d slope;
      const Vector2d moved = windows_.displacement(
          i, {static_cast<double>(motion.u), static_cast<double>(motion.v)}, &slope);
      const double u_sd = motion.u_sd, v_sd = motion.v_sd;
      results_[i] = {windows_.place(i).x(),
                     windows_.place(i).y(),
                     moved.x(),
                     moved.y(),
                     std::hypot(slope(0, 0) * u_sd, slope(0, 1) * v_sd),
                     std::hypot(slope(1, 0) * u_sd, slope(1, 1) * v_sd)};
    }
  }

  void correct_row(MotionRow& row) const {
    if (row.is_reference) {  // nothing has moved, by definition
      row.dx_m = row.dy_m = row.plane_rot_deg = 0;
      row.dx_sd_m = row.dy_sd_m = row.plane_rot_sd_deg = 0;
      return;
    }
    const camera::PlaneTurn whole = turn(region_, row);
    row.dx_m = whole.shift.x(), row.dy_m = whole.shift.y();
    row.plane_rot_deg = whole.angle * kDegPerRad;
    row.dx_sd_m = row.dx_sd_px * metre_per_px_, row.dy_sd_m = row.dy_sd_px * metre_per_px_;
    row.plane_rot_sd_deg = row.rot_sd_deg;
    if (!by_region_) fit_windows(row);
    add_camera(row);
  }

  camera::PlaneTurn turn(const PlaneField& region, const MotionRow& row) const {
    return camera::plane_turn(region, {row.dx_px, row.dy_px}, row.rot_deg * kRadPerDeg, centre_px_);
  }

  // A lens that bends the picture bends a rigid motion: it is fitted anew to the windows.
  void fit_windows(MotionRow& row) const {
    std::vector<dic::PointMotion> points;
    for (std::size_t i = 0; i < results_.size(); ++i) {
      const PlaneResult& one = results_[i];
      if (!std::isfinite(one.u_m)) continue;
      const Vector2d at = windows_.corrected_px(i);
      points.push_back({at.x(), at.y(), one.u_m / metre_per_px_, -one.v_m / metre_per_px_,
                        std::max(kLeastSd_px, std::hypot(one.u_sd_m, one.v_sd_m) /
                                                  (std::sqrt(2.0) * metre_per_px_))});
    }
    const Vector2d centre = region_.corrected_px(region_.size() / 2);
    dic::RigidMotion motion = dic::fit_rigid_motion(points, centre.x(), centre.y());
    if (!motion.ok) return;
    motion::account_for_overlap(motion, window_px_, spacing_px_);
    row.dx_m = motion.dx_px * metre_per_px_;
    row.dy_m = -motion.dy_px * metre_per_px_;
    row.plane_rot_deg = motion.rot_rad * kDegPerRad;
    row.dx_sd_m = motion.dx_sd_px * metre_per_px_;
    row.dy_sd_m = motion.dy_sd_px * metre_per_px_;
    row.plane_rot_sd_deg = motion.rot_sd_rad * kDegPerRad;
  }

  // By differences along the principal axes of the camera's covariance (JCGM 102:2011).
  void add_camera(MotionRow& row) const {
    for (const RegionStep& step : steps_) {
      const camera::PlaneTurn plus = turn(step.plus, row), minus = turn(step.minus, row);
      const double width = 2 * step.deviations;
      const Vector2d shift = (plus.shift - minus.shift) / width;
      row.dx_sd_m = std::hypot(row.dx_sd_m, shift.x());
      row.dy_sd_m = std::hypot(row.dy_sd_m, shift.y());
      const double angle = std::remainder(plus.angle - minus.angle, 2 * kPi) / width;
      row.plane_rot_sd_deg = std::hypot(row.plane_rot_sd_deg, angle * kDegPerRad);
    }
  }

  int window_px_, spacing_px_;
  bool by_region_;
  double metre_per_px_;
  Vector2d centre_px_;
  PlaneField windows_, region_;
  std::vector<RegionStep> steps_;
  std::vector<PlaneResult> results_;
};

PlaneMotion::PlaneMotion(const Camera& camera, std::span<const Window> windows,
                         const CorrelateRequest& request, const Roi& roi, int spacing_px)
    : impl_(std::make_unique<Impl>(camera, windows, request, roi, spacing_px)) {}
PlaneMotion::~PlaneMotion() = default;

std::span<const PlaneResult> PlaneMotion::correct(std::span<const WindowMotion> field,
                                                  MotionRow& row) {
  return impl_->correct(field, row);
}

}  // namespace impactdic::run
