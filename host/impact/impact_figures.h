// From flights and contact instants to restitution, friction and closure, each with its deviation.
// Internal to the impact analysis.
#pragma once

#include <Eigen/Core>
#include <functional>

#include "host/impact/flight_fit.h"
#include "host/impact/impact_phases.h"

namespace impactdic::impact {

// What the figures are made of: flight states at fixed instants (FlightState), then these.
enum ImpactSource { kStart = kFlightStates, kEnd, kSpin0, kSpin1, kImpactSources };

struct ImpactSources {
  using Vector = Eigen::Matrix<double, kImpactSources, 1>;
  using Matrix = Eigen::Matrix<double, kImpactSources, kImpactSources>;
  Vector value;
  Matrix covariance;
  FlightRange before, after;
  GravityDirection direction;
  double gravity = 0;  // px/frame^2
};

// Fills velocities, restitution, friction, rolling cap and closure of `result`, whose radius is
// known already.
void fill_figures(const ImpactSources& sources, const ImpactOptions& options,
                  ImpactAnalysis& result);

// When the flight before and the flight after, carried on, are at the same height.
double crossing_of(const ImpactSources& sources, const ImpactSources::Vector& x);

// First-order propagation of the covariance through `figure`.
Measured propagate(const ImpactSources& sources,
                   const std::function<double(const ImpactSources::Vector&)>& figure);

}  // namespace impactdic::impact
