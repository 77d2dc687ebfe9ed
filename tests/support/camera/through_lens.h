// What a track would hold if a camera with distortion had filmed it.
#pragma once

#include <impactdic/track.h>

#include <vector>

#include "host/camera/ball_view.h"
#include "host/dic/rim_margin.h"
#include "host/run/metres/camera_part.h"
#include "tests/support/filmed_shot.h"

namespace impactdic::testing {

// Square to the plane; `k1_at_corner`: the share by which the lens moves the corners outwards.
inline Camera bent_camera(int side_px, double metre_per_px, double k1_at_corner = 0.01) {
  using P = CameraParameter;
  Camera camera;
  camera.width = camera.height = side_px;
  camera.from = "dots";
  camera.focal_length_known = true;
  camera[P::kFx] = camera[P::kFy] = 4.0 * side_px;
  camera[P::kCx] = camera[P::kCy] = (side_px - 1) / 2.0;
  const double corner = side_px / 2.0 * 1.4142135623730951 / camera[P::kFx];
  camera[P::kK1] = k1_at_corner / (corner * corner);
  camera[P::kPositionZ] = camera[P::kFx] * metre_per_px;
  return camera;
}

// `rows`: as they would be without a lens, `metre_per_px` in the plane, (0, height - 1) at the
// origin of the world axes. Deviations stay.
inline std::vector<TrackRow> through_lens(const Camera& camera, const std::vector<TrackRow>& rows,
                                          double metre_per_px, bool sphere = false) {
  const camera::PlaneView plane(camera);
  const camera::BallView view(plane, sphere, dic::kRimMarginPx);
  std::vector<TrackRow> seen = rows;
  for (TrackRow& row : seen) {
    if (!row.circle_ok) continue;
    const camera::BallInPlane ball{
        {row.cx_px * metre_per_px, (camera.height - 1 - row.cy_px) * metre_per_px},
        row.r_px * metre_per_px};
    const camera::CircleInPicture circle = view.circle(ball);
    row.cx_px = circle.centre.x();
    row.cy_px = circle.centre.y();
    row.r_px = circle.radius;
    if (!row.motion_ok) continue;
    const camera::TurnInPlane motion = view.motion_in_picture(
        ball, circle,
        {{row.dx_px * metre_per_px, -row.dy_px * metre_per_px}, row.rot_deg * kRadPerDeg});
    row.dx_px = motion.shift.x();
    row.dy_px = motion.shift.y();
    row.rot_deg = motion.angle * kDegPerRad;
  }
  return seen;
}

// The shot's figures, its rows being as the camera shows them.
inline void conclude_through(const Camera& camera, FilmedShot& shot) {
  run::conclude_through_camera(camera, shot.request, shot.result.rows, std::nullopt, shot.result);
}

}  // namespace impactdic::testing
