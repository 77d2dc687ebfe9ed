#include "host/pipeline/fill_row.h"

#include <cmath>

namespace impactdic::pipeline {

void set_circle(TrackRow& row, const circle::CircleFit& fit) {
  row.circle_ok = fit.status == circle::CircleStatus::kOk;
  row.status = fit.status == circle::CircleStatus::kOk          ? TrackStatus::kOk
               : fit.status == circle::CircleStatus::kOutOfView ? TrackStatus::kOutOfView
                                                                : TrackStatus::kNoBall;
  if (!row.circle_ok) return;
  row.cx_px = fit.circle.cx_px;
  row.cy_px = fit.circle.cy_px;
  row.r_px = fit.circle.r_px;
  row.cx_sd_px = fit.cx_sd_px;
  row.cy_sd_px = fit.cy_sd_px;
  row.r_sd_px = fit.r_sd_px;
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
  // The point that was followed is off the ball's centre by the circle's error, and turns about it.
  if (!row.circle_ok) return;
  const double c = std::cos(motion.rot_rad) - 1, s = std::sin(motion.rot_rad);
  row.dx_sd_px = std::hypot(row.dx_sd_px, c * row.cx_sd_px, s * row.cy_sd_px);
  row.dy_sd_px = std::hypot(row.dy_sd_px, s * row.cx_sd_px, c * row.cy_sd_px);
}

}  // namespace impactdic::pipeline
