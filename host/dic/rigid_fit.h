// The rigid motion (u, v, rotation) that a displacement field carries, found robustly.
#pragma once

#include <span>

namespace impactdic::dic {

// One measured displacement at one point, px, image axes (y down); sd one standard deviation.
struct PointMotion {
  double x_px = 0, y_px = 0, u_px = 0, v_px = 0, sd_px = 1;
};

struct RigidMotion {
  bool ok = false;
  double dx_px = 0, dy_px = 0;  // of the point (cx, cy)
  double rot_rad = 0;           // counter-clockwise as seen on the screen
  double dx_sd_px = 0, dy_sd_px = 0, rot_sd_rad = 0;
  // Of a sphere: the whole turn is the rotation vector (rot_x_rad, rot_y_rad, rot_rad) in the
  // camera's axes, X right, Y up, Z towards the camera. Its displacement and its turn about the
  // axis across it look alike: the correlation of their errors. 0 of a flat ball.
  double rot_x_rad = 0, rot_y_rad = 0;
  double rot_x_sd_rad = 0, rot_y_sd_rad = 0;
  double dx_rot_y_corr = 0, dy_rot_x_corr = 0;
  int used = 0;            // points that carried weight
  double residual_px = 0;  // robust scatter of the points about the motion
};

// Weighted Kabsch/Procrustes fit of a rotation about (cx, cy) and a translation with Tukey weights
// (Arun, Huang and Blostein 1987; Beaton and Tukey 1974), started from a consensus so that up to
// half of the points may be wrong. Finite rotations are exact. Where the points are strained beyond
// chance (a ball under compression) a uniform strain is fitted along, so that it bends neither the
// centre's motion nor the rotation. Fewer than three points: not ok.
RigidMotion fit_rigid_motion(std::span<const PointMotion> points, double cx_px, double cy_px);

}  // namespace impactdic::dic
