#include "host/camera/correct_rows.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace impactdic::camera {

using Eigen::Matrix2d;
using Eigen::Vector2d;

namespace {

CircleInPicture circle_of(const TrackRow& row) { return {{row.cx_px, row.cy_px}, row.r_px}; }

// Deviations along x and y, which are stated without a covariance.
void spread(const Matrix2d& slope, double& x_sd, double& y_sd) {
  const double x = std::hypot(slope(0, 0) * x_sd, slope(0, 1) * y_sd);
  y_sd = std::hypot(slope(1, 0) * x_sd, slope(1, 1) * y_sd);
  x_sd = x;
}

}  // namespace

RowCorrection::RowCorrection(const Camera& camera, bool sphere, double metre_per_px,
                             double rim_margin_px)
    : plane_(camera),
      sphere_(sphere && camera.focal_length_known),
      ball_(plane_, sphere_, rim_margin_px),
      metre_per_px_(metre_per_px),
      height_(camera.height) {}

Vector2d RowCorrection::to_corrected(const Vector2d& world) const {
  return {world.x() / metre_per_px_, height_ - 1 - world.y() / metre_per_px_};
}

CircleInPicture RowCorrection::followed(const TrackRow& row, const BallInPlane& ball) const {
  CircleInPicture circle = circle_of(row);
  if (sphere_) circle.centre = plane_.to_picture({ball.centre.x(), ball.centre.y(), 0});
  return circle;
}

void RowCorrection::correct_circle(const BallInPlane& ball, TrackRow& row) const {
  Matrix2d slope;
  const Vector2d seen(row.cx_px, row.cy_px);
  const Vector2d world = plane_.to_plane(seen, 0, &slope);
  slope /= metre_per_px_;
  const Vector2d centre = to_corrected(ball.centre);
  if (std::isfinite(row.rim_off_x_px)) {
    const Vector2d rim = plane_.to_plane(seen + Vector2d(row.rim_off_x_px, row.rim_off_y_px));
    const Vector2d off = to_corrected(rim) - to_corrected(world);
    row.rim_off_x_px = off.x();
    row.rim_off_y_px = off.y();
    spread(slope, row.rim_x_sd_px, row.rim_y_sd_px);
  }
  row.cx_px = centre.x();
  row.cy_px = centre.y();
  row.r_px = ball.radius / metre_per_px_;
  spread(slope, row.cx_sd_px, row.cy_sd_px);
  row.r_sd_px *= std::sqrt(std::abs(slope.determinant()));
  row.circle_ok = std::isfinite(row.cx_px);
}

void RowCorrection::correct_motion(const TrackRow& seen, const BallInPlane& ball,
                                   TrackRow& row) const {
  const CircleInPicture circle = followed(seen, ball);
  const Vector2d centre = circle.centre;
  const TurnInPlane motion =
      ball_.motion(ball, circle, {{seen.dx_px, seen.dy_px}, seen.rot_deg * kRadPerDeg});
  Matrix2d slope;
  plane_.to_plane(centre + Vector2d(seen.dx_px, seen.dy_px), 0, &slope);
  slope /= metre_per_px_;
  row.dx_px = motion.shift.x() / metre_per_px_;
  row.dy_px = -motion.shift.y() / metre_per_px_;
  row.rot_deg = motion.angle * kDegPerRad;
  spread(slope, row.dx_sd_px, row.dy_sd_px);
  if (std::isfinite(seen.centre_u_px)) {
    const Vector2d moved = plane_.to_plane(centre + Vector2d(seen.centre_u_px, seen.centre_v_px)) -
                           plane_.to_plane(centre);
    row.centre_u_px = moved.x() / metre_per_px_;
    row.centre_v_px = -moved.y() / metre_per_px_;
    spread(slope, row.centre_u_sd_px, row.centre_v_sd_px);
  }
  row.motion_ok = std::isfinite(row.dx_px);
}

// The pose is against that of another frame: the motion from there to here.
void RowCorrection::correct_pose(const std::vector<TrackRow>& seen, TrackRow& row) const {
  BodyPose& pose = row.pose;
  const Vector2d at(pose.x_px, pose.y_px);
  const auto origin =
      std::lower_bound(seen.begin(), seen.end(), pose.origin,
                       [](const TrackRow& one, std::int64_t frame) { return one.frame < frame; });
  Matrix2d slope;
  Vector2d world = plane_.to_plane(at, 0, &slope);
  if (origin != seen.end() && origin->frame == pose.origin && origin->circle_ok) {
    const BallInPlane ball = ball_.ball(circle_of(*origin));
    const CircleInPicture circle = followed(*origin, ball);
    const bool flat = std::isfinite(pose.angle_rad);
    const TurnInPlane motion =
        ball_.motion(ball, circle, {at - circle.centre, flat ? pose.angle_rad : 0.0});
    world = ball.centre + motion.shift;
    // The angle is not wrapped.
    if (flat) pose.angle_rad += std::remainder(motion.angle - pose.angle_rad, 2 * kPi);
  }
  const Vector2d corrected = to_corrected(world);
  pose.x_px = corrected.x();
  pose.y_px = corrected.y();
  spread(slope / metre_per_px_, pose.x_sd_px, pose.y_sd_px);
  pose.key_dx_px = pose.key_dy_px = kNotMeasured;  // as the camera saw it
  pose.key_rot_x_deg = pose.key_rot_y_deg = pose.key_rot_deg = kNotMeasured;
  pose.ok = corrected.allFinite();
}

std::vector<TrackRow> RowCorrection::correct(const std::vector<TrackRow>& rows) const {
  std::vector<TrackRow> corrected = rows;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].pose.ok) correct_pose(rows, corrected[i]);
    if (!rows[i].circle_ok) continue;
    const BallInPlane ball = ball_.ball(circle_of(rows[i]));
    if (rows[i].motion_ok) correct_motion(rows[i], ball, corrected[i]);
    correct_circle(ball, corrected[i]);
  }
  return corrected;
}

}  // namespace impactdic::camera
