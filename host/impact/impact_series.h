// A track turned into the surface's axes, in pixels and frames. Internal to the impact analysis.
#pragma once

#include <cstddef>
#include <vector>

#include "host/clip/track_row.h"

namespace impactdic::impact {

// Row i of the track is the instant i. Local axes: t along the surface, n out of it, both px.
// What was not measured is NaN.
struct ImpactSeries {
  std::vector<double> position_t, position_n, position_sd;  // of the circle's centre
  std::vector<double> step_t, step_n, step_sd;              // motion from i to i + 1
  std::vector<double> turn, turn_sd;                        // rad, from i to i + 1
  bool from_circle = false;  // no motion was measured: steps are differences of positions

  std::size_t size() const { return position_n.size(); }
};

// `surface_angle_rad` counter-clockwise from image-right.
ImpactSeries impact_series(const std::vector<TrackRow>& rows, double surface_angle_rad);

// `count` values that scatter by `scatter` of the deviation which each of them states: the share of
// its square that they must have in common, beyond chance (three deviations). A steady ball meets
// the same fraction of a pixel in every frame, with the same bias of the interpolation: a mean over
// many frames is no better than that.
double common_share(double scatter, std::size_t count);

}  // namespace impactdic::impact
