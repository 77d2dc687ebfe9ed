#include "host/pipeline/rows/fill_row.h"

#include <algorithm>
#include <cmath>

#include "host/dic/sphere/sphere_errors.h"
#include "host/motion/unseen_tilt.h"
#include "host/pipeline/rows/compare_rows.h"

namespace impactdic::pipeline {

namespace {

bool is_sphere(const dic::RigidMotion& motion) { return motion.rot_x_sd_rad > 0; }

// The motion was taken to be that of a sphere about the circle's centre.
void set_sphere(TrackRow& row, dic::RigidMotion motion, const BallLight& light) {
  if (row.circle_ok) {
    dic::SphereSource circle{row.r_px, 0, row.cx_sd_px, row.cy_sd_px};
    circle.light = light;
    dic::add_source_errors(motion, circle);
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

TrackRow row_without_ball(const FrameRange& frames, double fps,
                          std::span<const std::int64_t> periods, std::int64_t index) {
  // With those that the camera lost.
  const auto period = [&](std::int64_t i) {
    return periods.empty() ? i : periods[static_cast<std::size_t>(i)];
  };
  TrackRow row;
  row.frame = frames.at(index);
  const double rate = fps > 0 ? fps / static_cast<double>(frames.step) : kNotMeasured;
  row.time_s = static_cast<double>(period(index)) / rate;
  if (index + 1 < frames.count()) {
    row.periods = static_cast<int>(period(index + 1) - period(index));
  }
  return row;
}

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

void set_motion(TrackRow& row, const dic::RigidMotion& motion, const motion::Stretch& stretch,
                const BallLight& light) {
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
    set_sphere(row, motion, light);
    return;
  }
  // The point that was followed is off the ball's centre by the circle's error, turns about it and
  // is carried towards it where the ball is compressed.
  if (!row.circle_ok) return;
  const motion::Gradient by = motion::gradient_of(stretch, motion.rot_rad);
  const auto with_centre = [&](double sd_px, double by_x, double by_y) {
    return std::hypot(sd_px, by_x * row.cx_sd_px, by_y * row.cy_sd_px);
  };
  row.dx_sd_px = with_centre(row.dx_sd_px, by.xx - 1, by.xy);
  row.dy_sd_px = with_centre(row.dy_sd_px, by.yx, by.yy - 1);
}

void state_motion(TrackRow& row, const TrackRow& next, const motion::PairMotion& pair,
                  const BallLight& light, bool doubted) {
  set_motion(row, pair.motion, pair.stretch, light);
  if (doubted) doubt_motion(row, next);
}

void set_pair(TrackRow& row, const TrackRow& next, motion::PairMotion& pair, const BallLight& light,
              bool doubted) {
  // Of a ball that may be a sphere, few edges and no window look like the motion of a disc, too.
  if (doubted && pair.motion.used == 0 && pair.motion.ok) {
    pair.motion.ok = false;
    pair.status = TrackStatus::kNoTexture;
  }
  state_motion(row, next, pair, light, doubted);
  if (row.status == TrackStatus::kOk) row.status = pair.status;
  compare_with_circles(row, next);
  if (!pair.centre.ok) return;
  row.centre_u_px = pair.centre.u_px;
  row.centre_v_px = pair.centre.v_px;
  row.centre_u_sd_px = pair.centre.u_sd_px;
  row.centre_v_sd_px = pair.centre.v_sd_px;
}

void set_round_motion(TrackRow& row, const dic::RigidMotion& motion) {
  row.motion_ok = true;
  row.dx_px = motion.dx_px;
  row.dy_px = motion.dy_px;
  row.dx_sd_px = motion.dx_sd_px;
  row.dy_sd_px = motion.dy_sd_px;
  row.rot_deg = motion.rot_rad * kDegPerRad;
  row.rot_x_deg = motion.rot_x_rad * kDegPerRad;
  row.rot_y_deg = motion.rot_y_rad * kDegPerRad;
  row.rot_sd_deg = motion.rot_sd_rad * kDegPerRad;
  row.rot_x_sd_deg = motion.rot_x_sd_rad * kDegPerRad;
  row.rot_y_sd_deg = motion.rot_y_sd_rad * kDegPerRad;
}

void place_in_clip(TrackRow& row, const Roi& roi, const FrameRange& frames) {
  row.cx_px += roi.x;
  row.cy_px += roi.y;
  if (!row.pose.ok) return;
  row.pose.x_px += roi.x;
  row.pose.y_px += roi.y;
  row.pose.origin = frames.at(row.pose.origin);
  row.pose.keyframe = frames.at(row.pose.keyframe);
}

void forget_way(TrackRow& row) {
  row.motion_ok = false;
  row.dx_px = row.dy_px = row.dx_sd_px = row.dy_sd_px = kNotMeasured;
  row.centre_u_px = row.centre_v_px = row.centre_u_sd_px = row.centre_v_sd_px = kNotMeasured;
  row.dx_rot_y_corr = row.dy_rot_x_corr = kNotMeasured;
}

void forget_motion(TrackRow& row) {
  forget_way(row);
  row.windows = 0;
  row.rot_deg = row.rot_sd_deg = kNotMeasured;
  row.rot_x_deg = row.rot_y_deg = row.rot_x_sd_deg = row.rot_y_sd_deg = kNotMeasured;
}

void doubt_motion(TrackRow& row, const TrackRow& next) {
  if (!row.motion_ok || !row.circle_ok || !next.circle_ok) return;
  const double x_px = std::hypot(row.cx_sd_px, next.cx_sd_px);
  const double y_px = std::hypot(row.cy_sd_px, next.cy_sd_px);
  row.dx_sd_px = std::max(row.dx_sd_px, x_px);
  row.dy_sd_px = std::max(row.dy_sd_px, y_px);
  const double tilt_rad = motion::tilt_that_moves(std::hypot(x_px, y_px), row.r_px);
  row.rot_sd_deg = std::hypot(row.rot_sd_deg, motion::turned_by_tilt(tilt_rad) * kDegPerRad);
}

TrackStatus status_behind(const TrackRow& before) {
  if (before.status == TrackStatus::kRepeated) return TrackStatus::kLastFrame;
  if (!before.circle_ok) return TrackStatus::kNoBall;
  return before.status == TrackStatus::kOk ? TrackStatus::kLastFrame : before.status;
}

}  // namespace impactdic::pipeline
