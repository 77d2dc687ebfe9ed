// Where the unknowns of a flight's least squares stand. Internal to the impact analysis.
#pragma once

#include <Eigen/Dense>
#include <array>

#include "host/impact/flight/flight_data.h"

namespace impactdic::impact {

// In order: states; gravity where it is not given, or the acceleration across it; of a sphere its
// radius and this over the camera's distance; of it, and of a flat ball on keyframes, how far the
// point that is followed lies off the centre; of the flat one the same of its circles on the mean,
// of the sphere its spins and what foreshortening makes of them.
class Unknowns {
 public:
  Unknowns(int flights, bool sphere, bool free_acceleration, bool across)
      : flights_(flights), sphere_(sphere), free_(free_acceleration), across_(across) {}
  // By registrations against keyframes from now on.
  void link() { linked_ = true; }
  void unlink() { linked_ = false; }
  bool is_linked() const { return linked_; }
  // The place that poses of a flat ball follow was a circle's centre with this deviation.
  void follow(int flight, double circle_sd_px);

  int states() const { return flights_ * kStatesOfOne; }
  int radius() const { return states() + (free_ ? 1 : 0); }
  int nearness() const { return radius() + 1; }
  bool has_offsets() const { return sphere_ || linked_; }
  int offset(int flight) const { return radius() + (sphere_ ? 2 : 0) + 2 * flight; }
  bool has_rims() const { return !sphere_ && linked_; }
  int rim(int flight) const { return offset(flights_) + 2 * flight; }
  int spins() const { return linked_ ? 3 : 2; }  // of a sphere's flight
  int spin(int flight) const { return offset(flights_) + spins() * flight; }
  int model(int flight) const { return spin(flights_) + 2 * flight; }
  int count() const {
    if (!sphere_) return linked_ ? rim(flights_) : radius();
    return linked_ ? model(flights_) : spin(flights_);
  }

  Eigen::VectorXd row_of(const Datum& d) const;
  // What is known of them before, into the normal equations. `circle_sd_px`: what a circle states.
  void add_priors(const ImpactSeries& series, double circle_sd_px, Eigen::MatrixXd& normal) const;

 private:
  int flights_;
  bool sphere_, free_, across_, linked_ = false;
  std::array<double, 2> followed_sd_px_{};
};

}  // namespace impactdic::impact
