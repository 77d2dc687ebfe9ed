// A flight's velocity along one axis, twice: the weighted mean of its steps, and the slope of the
// weighted line through its centres. Internal to the impact analysis.
#pragma once

#include "host/impact/flight/flight_data.h"
#include "host/impact/flight_fit.h"

namespace impactdic::impact {

struct VelocitySums {
  // Weights of the steps; weighted sums of them and of what a sphere's radius does to them.
  double steps = 0, step = 0, to_radius = 0, to_nearness = 0;

  // A row with a deviation of `sd`, `value` without what gravity makes of it; others than centres
  // and steps are passed over.
  void add(const Datum& d, double sd, double value) {
    const double weight = 1 / (sd * sd);
    if (d.kind == DatumKind::kStep) {
      steps += weight, step += weight * value;
      to_radius += weight * d.radius_slope, to_nearness += weight * d.nearness_slope;
    } else if (d.kind == DatumKind::kCentre) {
      const double at = d.slope[static_cast<std::size_t>(d.normal ? kVn0 : kVt0)];
      w_ += weight, wx_ += weight * at, wxx_ += weight * at * at;
      wy_ += weight * value, wxy_ += weight * at * value;
    }
  }

  bool tell_both() const { return steps > 0 && spread() > 0; }
  double slope_of_centres() const { return (w_ * wxy_ - wx_ * wy_) / spread(); }
  double variance_of_slope() const { return w_ / spread(); }

 private:
  double spread() const { return w_ * wxx_ - wx_ * wx_; }
  double w_ = 0, wx_ = 0, wxx_ = 0, wy_ = 0, wxy_ = 0;  // of the centres, x: frames
};

}  // namespace impactdic::impact
