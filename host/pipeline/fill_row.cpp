#include "host/pipeline/fill_row.h"

#include <cmath>

#include "host/dic/sphere/sphere_errors.h"

namespace impactdic::pipeline {

namespace {

bool is_sphere(const dic::RigidMotion& motion) { return motion.rot_x_sd_rad > 0; }

// The motion was taken to be that of a sphere about the circle's centre.
void set_sphere(TrackRow& row, dic::RigidMotion motion) {
  if (row.circle_ok) {
    dic::add_source_errors(motion, {row.r_px, 0, row.cx_sd_px, row.cy_sd_px});
  }
  row.dx_sd_px = motion.dx_sd_px;
  row.dy_sd_px = motion.dy_sd_px;
  row.rot_sd_deg = motion.rot_sd_rad * kDegPerRad;
  row.rot_x_deg = motion.rot_x_rad * kDegPerRad;
  row.rot_y_deg = motion.rot_y_rad * kDegPerRad;
  row.rot_x_sd_deg = motion.rot_x_sd_rad * kDegPerRad;
  row.rot_y_sd_deg = motion.rot_y_sd_rad * kDegPerRad;
  row.dx_rot_y_corr = motion.dx_rot_y_corr;
  row.dy_rot_x_corr = motion.dy_rot_x_corr;
}

}  // namespace

void set_circle(TrackRow& row, const circle::CircleFit& fit) {
  row.circle_ok = fit.status == circle::CircleStatus::kOk;
  row.status = fit.status == circle::CircleStatus::kOk          ? TrackStatus::kOk
               : fit.status == circle::CircleStatus::kOutOfView ? TrackStatus::kOutOfView
                                                                : TrackStatus::kNoBall;
  row.by_hand = fit.by_hand;
  if (!row.circle_ok) return;
  row.cx_px = fit.circle.cx_px;
  row.cy_px = fit.circle.cy_px;
  row.r_px = fit.circle.r_px;
  row.cx_sd_px = fit.cx_sd_px;
  row.cy_sd_px = fit.cy_sd_px;
  row.r_sd_px = fit.r_sd_px;
  if (!fit.ellipse) return;
  row.e1_px = fit.e1_px;
  row.e2_px = fit.e2_px;
  row.e1_sd_px = fit.e1_sd_px;
  row.e2_sd_px = fit.e2_sd_px;
}

void set_motion(TrackRow& row, const dic::RigidMotion& motion) {
  row.motion_ok = motion.ok;
  row.windows = motion.used;
  if (!motion.ok) return;
  row.dx_px = motion.dx_px;
  row.dy_px = motion.dy_px;
  row.rot_deg = motion.rot_rad * kDegPerRad;
  row.dx_sd_px = motion.dx_sd_px;
  row.dy_sd_px = motion.dy_sd_px;
  row.rot_sd_deg = motion.rot_sd_rad * kDegPerRad;
  if (is_sphere(motion)) {
    set_sphere(row, motion);
    return;
  }
  // The point that was followed is off the ball's centre by the circle's error, and turns about it.
  if (!row.circle_ok) return;
  const double c = std::cos(motion.rot_rad) - 1, s = std::sin(motion.rot_rad);
  row.dx_sd_px = std::hypot(row.dx_sd_px, c * row.cx_sd_px, s * row.cy_sd_px);
  row.dy_sd_px = std::hypot(row.dy_sd_px, s * row.cx_sd_px, c * row.cy_sd_px);
}

void compare_with_circles(TrackRow& row, const TrackRow& next) {
  constexpr double kChance = 6, kLeast_px = 0.1;
  if (row.status != TrackStatus::kOk || !row.motion_ok || !next.circle_ok) return;
  const auto differ = [](double motion, double motion_sd, double step, double sd, double next_sd) {
    const double off = std::abs(motion - step);
    return off > kLeast_px && off > kChance * std::hypot(motion_sd, sd, next_sd);
  };
  if (differ(row.dx_px, row.dx_sd_px, next.cx_px - row.cx_px, row.cx_sd_px, next.cx_sd_px) ||
      differ(row.dy_px, row.dy_sd_px, next.cy_px - row.cy_px, row.cy_sd_px, next.cy_sd_px)) {
    row.status = TrackStatus::kInconsistent;
  }
}

}  // namespace impactdic::pipeline
