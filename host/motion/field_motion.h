// From a ball's circle in two frames to the windows on its surface, and from their measured
// displacements to its rigid motion.
#pragma once

#include <span>
#include <vector>

#include "host/circle/circle.h"
#include "host/clip/track_row.h"
#include "host/dic/field.h"
#include "host/dic/rigid_fit.h"

namespace impactdic::dic {
struct SphereGuess;
}  // namespace impactdic::dic

namespace impactdic::motion {

// What is expected of a motion before it is measured: displacement of (cx, cy) and rotation
// (counter-clockwise on screen).
struct MotionGuess {
  double cx_px = 0, cy_px = 0, dx_px = 0, dy_px = 0, rot_rad = 0;
};

// Sets frames and guess of every window to where `guess` carries its centre; `seeds`, one a window
// or none, to the same without rounding.
void aim_windows(std::span<Window> windows, int window_px, int first_slot, int second_slot,
                 const MotionGuess& guess, std::span<WindowMotion> seeds = {});

// The same on a sphere; a window that is turned out of sight is sought where it would have gone.
void aim_on_sphere(std::span<Window> windows, int window_px, int first_slot, int second_slot,
                   const dic::SphereGuess& guess, std::span<WindowMotion> seeds = {});

// The measured windows as points for the rigid fit: those with status ok, at their centres. Their
// sd is at least `floor_px`, so that no window with a lucky residual outweighs the rest.
std::vector<dic::PointMotion> field_points(std::span<const Window> windows,
                                           std::span<const WindowMotion> motions, int window_px,
                                           double floor_px = 0.002);

// Windows that overlap share pixels and so their noise: every pixel lies in (window / spacing)² of
// them, and by as much fewer are independent. Widens the deviations of a motion fitted to them.
void account_for_overlap(dic::RigidMotion& motion, int window_px, int spacing_px);

// Displacement of the point (cx, cy) by a locally weighted linear fit to the field about it
// (Cleveland 1979, tricube weights over the nearest windows, robust), as section 2.2 interpolates
// the velocity at the centroid.
struct CentreMotion {
  bool ok = false;
  double u_px = 0, v_px = 0, u_sd_px = 0, v_sd_px = 0;
};
CentreMotion interpolate_at(std::span<const dic::PointMotion> points, double cx_px, double cy_px);

// How the field stretches: the strain of a robust affine fit to all of it, free of rotation
// (Green-Lagrange, largest principal value by magnitude), and its standard deviation. `rigid`:
// their motion about (cx, cy) without strain, which spares digits; any will do.
struct FieldStrain {
  bool ok = false;
  double largest = 0, sd = 0;
};
FieldStrain fit_strain(std::span<const dic::PointMotion> points, const dic::RigidMotion& rigid,
                       double cx_px, double cy_px);

// Of the windows that have texture and lie in view, the share that agrees on `motion`, 0 … 1. Where
// the windows looked in the wrong place some of them agree by chance: up to a sixth.
double agreeing_share(const dic::RigidMotion& motion, std::span<const WindowMotion> motions);

// Why too few windows carried a motion.
TrackStatus explain_failure(std::span<const WindowMotion> motions);

}  // namespace impactdic::motion
