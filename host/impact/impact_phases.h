// One impact in a track: when it begins, turns and ends, and what it does to the motion.
//
// Everything comes out of the motion itself, no model of the contact beyond its onset is assumed.
// Instants count analysed frames from 0; lengths are px, velocities px/frame, spins rad/frame, as
// the track has them. Axes: global x right, y up; local t along the surface, n out of it.
// Rotation is positive counter-clockwise as seen on the screen.
#pragma once

#include <impactdic/impact.h>

#include <array>
#include <optional>
#include <vector>

#include "host/clip/track_rows.h"

namespace impactdic::impact {

struct ImpactOptions {
  double surface_angle_rad = 0;     // counter-clockwise from image-right
  double surface_angle_sd_rad = 0;  // 0: exact
  double gravity_angle_rad = -kPi / 2;
  // px/frame^2; nullopt: unknown, fitted to the flights.
  std::optional<double> gravity;
  // I / (m R^2): 2/3 of a thin shell, 2/5 of a solid sphere.
  std::optional<double> inertia_factor;
  // The free ball's, where the rim is not what tells it; nullopt: from the rows.
  std::optional<Measured> radius_px;
  // Of a sphere's radius over the camera's distance the deviation, which the rows' turns out of the
  // picture's plane hold, and where the optical axis is in the rows.
  double nearness_sd = 0;
  std::array<double, 2> axis_px{};
  // Of the camera from the ball, px; nullopt: not known, and so no velocity towards it.
  std::optional<Measured> distance_px;
  // What the film itself may displace the ball by, px, beside what scatters: a path that bends by
  // no more is smooth.
  double path_sd_px = 0;
  // Known from elsewhere: evidence for it is not weighed. Expected, as of a shot that is to be
  // fitted: it need be no more than as likely as none.
  bool impact_is_known = false, impact_is_expected = false;
  int flight_frames = 100;  // longest flight used on each side (dissertation, section 3.2.2)
};

// Analyses the sharpest turn away from the surface among `rows`. Never throws for what a clip
// shows: the status says it.
ImpactAnalysis analyse_impact(const TrackRows& rows, const ImpactOptions& options);

// The impacts before and after `known`, one that was found in `rows`, in order of time: a ball that
// bounces again and again has many. Each is analysed between its neighbours, and a flight between
// two of them belongs to both.
std::vector<ImpactAnalysis> other_impacts(const TrackRows& rows, const ImpactOptions& options,
                                          const ImpactAnalysis& known);

}  // namespace impactdic::impact
