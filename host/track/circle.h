// The ball in a frame as a circle: found by the Hough transform, measured by a sub-pixel fit.
#pragma once

#include <optional>
#include <utility>

#include "host/base/image.h"

namespace impactdic {

struct Circle {
  double cx_px = 0, cy_px = 0, r_px = 0;
};

enum class CircleStatus {
  ok,
  no_ball,      // no circular edge was found
  out_of_view,  // the centre lies outside the picture or too little of the rim is inside
};
const char* to_string(CircleStatus status);

// A measured circle with one standard deviation of each figure. With `ellipse` fitted,
// r(φ) = R + e1 cos 2φ + e2 sin 2φ (φ from x towards y, image axes, y down).
struct CircleFit {
  CircleStatus status = CircleStatus::no_ball;
  Circle circle;
  double cx_sd_px = 0, cy_sd_px = 0, r_sd_px = 0;
  double e1_px = 0, e2_px = 0;
  double residual_px = 0;      // robust scatter of the accepted rim points
  int rim_points = 0;          // accepted
  double rim_fraction = 0;     // share of the full rim that carried the fit, 0 … 1
};

struct CircleOptions {
  // Search range of the radius; from the picture's size where absent.
  std::optional<std::pair<double, double>> radius_range_px;
  int rays = 720;
  bool allow_ellipse = true;
  void validate() const;
};

// What earlier frames say of this one: where the ball should be and how large it is.
struct CirclePrior {
  Circle predicted;
  double centre_sd_px = 2.0;
  std::optional<double> radius_px, radius_sd_px;      // of the uncompressed ball
  std::optional<double> compression_axis_rad;         // image axes, y down
};

// Finds the ball anywhere in a frame (Hough transform on a prepared picture, section 3.2.1 of
// Ghaednia's dissertation); good to about a pixel. nullopt where there is none.
std::optional<Circle> find_ball(const Frame& frame, const CircleOptions& options);

// Measures the ball near `prior` to a fraction of a pixel: sub-pixel edge along radial rays with a
// local edge level, robust circle (or ellipse) fit.
CircleFit measure_circle(const Frame& frame, const CirclePrior& prior,
                         const CircleOptions& options);

}  // namespace impactdic
