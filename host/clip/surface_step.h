// How far a ball's surface goes from a frame to the next: its centre, and its rim as it turns.
#pragma once

#include <impactdic/track.h>
#include <impactdic/units.h>

#include <cmath>

namespace impactdic {

struct SurfaceStep {
  double x_px = 0, y_px = 0, turn_px = 0;
  SurfaceStep() = default;
  explicit SurfaceStep(const TrackRow& row)
      : x_px(row.dx_px), y_px(row.dy_px), turn_px(row.rot_deg * kRadPerDeg * row.r_px) {}
  static double sd_px(const TrackRow& row) {
    return std::hypot(row.dx_sd_px, row.dy_sd_px, row.rot_sd_deg * kRadPerDeg * row.r_px);
  }
  double length() const { return std::hypot(x_px, y_px, turn_px); }
  double dot(const SurfaceStep& other) const {
    return x_px * other.x_px + y_px * other.y_px + turn_px * other.turn_px;
  }
  // Adds so many times the other one.
  void add(const SurfaceStep& other, double times) {
    x_px += times * other.x_px;
    y_px += times * other.y_px;
    turn_px += times * other.turn_px;
  }
};

}  // namespace impactdic
