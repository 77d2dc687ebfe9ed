#include "host/clip/steady_rows.h"

#include <impactdic/units.h>

#include <Eigen/Geometry>
#include <cmath>

namespace impactdic {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

struct Point {
  double x, y;
};

// A point of the picture, turned back and shifted back.
Point against_background(const Point& seen, const PictureShift& shift, const CameraMotion& motion) {
  const double x = seen.x - motion.middle_x_px - shift.x_px;
  const double y = seen.y - motion.middle_y_px - shift.y_px;
  const double c = std::cos(shift.roll_rad), s = std::sin(shift.roll_rad);
  return {motion.middle_x_px + c * x + s * y, motion.middle_y_px - s * x + c * y};
}

// What the background's place at a point is not known by.
Point sd_at(const Point& at, const PictureShift& shift, const CameraMotion& motion) {
  return {std::hypot(shift.x_sd_px, (at.y - motion.middle_y_px) * shift.roll_sd_rad),
          std::hypot(shift.y_sd_px, (at.x - motion.middle_x_px) * shift.roll_sd_rad)};
}

void join(const Point& sd, double& x_sd, double& y_sd) {
  x_sd = std::hypot(x_sd, sd.x);
  y_sd = std::hypot(y_sd, sd.y);
}

// A displacement from `from`, between pictures of two shifts.
void steady_step(const Point& from, const PictureShift& here, const PictureShift& next,
                 const CameraMotion& motion, double& dx, double& dy) {
  const Point a = against_background(from, here, motion);
  const Point b = against_background({from.x + dx, from.y + dy}, next, motion);
  dx = b.x - a.x;
  dy = b.y - a.y;
}

// A rotation between two pictures, as it is without their rolls: rolls are from x towards y, which
// points down, so that a roll is a turn the other way about the axis towards the camera.
Quaterniond unrolled(const Quaterniond& turn, double roll_from_rad, double roll_to_rad) {
  const auto about_sight = [](double angle_rad) {
    return AngleAxisd(angle_rad, Vector3d::UnitZ());
  };
  return about_sight(roll_to_rad) * turn * about_sight(-roll_from_rad);
}

void unroll_vector(double roll_from_rad, double roll_to_rad, double& x_deg, double& y_deg,
                   double& z_deg) {
  const Vector3d turn = kRadPerDeg * Vector3d(x_deg, y_deg, z_deg);
  const AngleAxisd seen(turn.norm(), turn.stableNormalized());
  const AngleAxisd found(unrolled(Quaterniond(seen), roll_from_rad, roll_to_rad));
  const Vector3d vector = found.angle() * kDegPerRad * found.axis();
  x_deg = vector.x(), y_deg = vector.y(), z_deg = vector.z();
}

const PictureShift* shift_of_frame(std::int64_t frame, const TrackRow& row, std::size_t i,
                                   const CameraMotion& motion) {
  const std::int64_t at = static_cast<std::int64_t>(i) + (frame - row.frame) / motion.frame_step;
  if (frame < 0 || at < 0 || at >= static_cast<std::int64_t>(motion.of_rows.size())) return nullptr;
  const PictureShift& shift = motion.of_rows[static_cast<std::size_t>(at)];
  return shift.known ? &shift : nullptr;
}

void steady_pose(std::size_t i, const CameraMotion& motion, TrackRow& row) {
  BodyPose& pose = row.pose;
  const PictureShift& here = motion.of_rows[i];
  const PictureShift* origin = shift_of_frame(pose.origin, row, i, motion);
  const PictureShift* key = shift_of_frame(pose.keyframe, row, i, motion);
  if (origin == nullptr || key == nullptr) {
    pose = {};
    return;
  }
  if (std::isfinite(pose.key_dx_px)) {
    // A sphere's is about its circle, like that of its motion.
    const Point from = {row.cx_px - pose.key_dx_px, row.cy_px - pose.key_dy_px};
    steady_step(from, *key, here, motion, pose.key_dx_px, pose.key_dy_px);
    if (std::isfinite(pose.key_rot_x_deg)) {
      unroll_vector(key->roll_rad, here.roll_rad, pose.key_rot_x_deg, pose.key_rot_y_deg,
                    pose.key_rot_deg);
    } else {
      pose.key_rot_deg += (here.roll_rad - key->roll_rad) * kDegPerRad;
    }
  }
  const Point at = against_background({pose.x_px, pose.y_px}, here, motion);
  join(sd_at({pose.x_px, pose.y_px}, here, motion), pose.x_sd_px, pose.y_sd_px);
  pose.x_px = at.x, pose.y_px = at.y;
  pose.angle_rad += here.roll_rad - origin->roll_rad;
  pose.angle_sd_rad = std::hypot(pose.angle_sd_rad, here.roll_sd_rad);
  const Quaterniond turn(pose.qw, pose.qx, pose.qy, pose.qz);
  const Quaterniond q = unrolled(turn, origin->roll_rad, here.roll_rad);
  pose.qw = q.w(), pose.qx = q.x(), pose.qy = q.y(), pose.qz = q.z();
}

void steady_motion(const TrackRow& seen, const PictureShift& here, const PictureShift& next,
                   const CameraMotion& motion, TrackRow& row) {
  const Point from = {seen.cx_px, seen.cy_px};
  steady_step(from, here, next, motion, row.dx_px, row.dy_px);
  row.rot_deg += (next.roll_rad - here.roll_rad) * kDegPerRad;
  for (const PictureShift* shift : {&here, &next}) {
    const Point sd = sd_at(from, *shift, motion);
    join(sd, row.dx_sd_px, row.dy_sd_px);
    join(sd, row.centre_u_sd_px, row.centre_v_sd_px);
    row.rot_sd_deg = std::hypot(row.rot_sd_deg, shift->roll_sd_rad * kDegPerRad);
  }
  if (std::isfinite(row.centre_u_px)) {
    steady_step(from, here, next, motion, row.centre_u_px, row.centre_v_px);
  }
}

}  // namespace

TrackRow steadied(const TrackRow& seen, std::size_t i, const CameraMotion& motion) {
  TrackRow row = seen;
  const PictureShift& here = motion.of_rows[i];
  if (!here.known) {
    row.circle_ok = row.motion_ok = false;
    row.cx_px = row.cy_px = row.dx_px = row.dy_px = row.rot_deg = kNotMeasured;
    row.centre_u_px = row.centre_v_px = row.rot_x_deg = row.rot_y_deg = kNotMeasured;
    row.pose = {};
    if (row.status == TrackStatus::kOk) row.status = TrackStatus::kInconsistent;
    return row;
  }
  if (row.pose.ok) steady_pose(i, motion, row);
  if (!seen.circle_ok) return row;
  const bool last = i + 1 >= motion.of_rows.size();
  if (row.motion_ok && !last && motion.of_rows[i + 1].known) {
    steady_motion(seen, here, motion.of_rows[i + 1], motion, row);
  } else if (row.motion_ok) {
    row.motion_ok = false;
    row.dx_px = row.dy_px = row.rot_deg = row.rot_x_deg = row.rot_y_deg = kNotMeasured;
    row.centre_u_px = row.centre_v_px = kNotMeasured;
    if (row.status == TrackStatus::kOk) row.status = TrackStatus::kInconsistent;
  }
  const Point centre = {seen.cx_px, seen.cy_px}, sd = sd_at(centre, here, motion);
  join(sd, row.cx_sd_px, row.cy_sd_px);
  if (std::isfinite(row.rim_off_x_px)) join(sd, row.rim_x_sd_px, row.rim_y_sd_px);
  const Point at = against_background(centre, here, motion);
  row.cx_px = at.x, row.cy_px = at.y;
  return row;
}

}  // namespace impactdic
