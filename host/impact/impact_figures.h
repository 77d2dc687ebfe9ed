// From flights and contact instants to restitution, friction and closure, each with its deviation.
// Internal to the impact analysis.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>

#include "host/impact/flight_fit.h"
#include "host/impact/impact_phases.h"

namespace impactdic::impact {

// What the figures are made of: flight states at fixed instants (FlightState), then these.
enum ImpactSource {
  kStart = kFlightStates,
  kEnd,
  kSpin0,
  kSpin1,
  kRadius,
  kAngle,
  kGravity,
  kImpactSources
};

struct ImpactSources {
  using Vector = Eigen::Matrix<double, kImpactSources, 1>;
  using Matrix = Eigen::Matrix<double, kImpactSources, kImpactSources>;
  Vector value;
  std::array<Matrix, kErrorSources> covariance;  // of each ErrorSource; they are independent
  Vector per_gravity;  // of the sources, for a change of gravity that was given
  FlightRange before, after;
  GravityDirection direction;

  ImpactSources();
  // Counts `sd` of one source among the errors of `kind`.
  void add(ErrorSource kind, int source, double sd);
  double gravity() const { return value[kGravity]; }  // px/frame^2
};

// A figure with the budget of its deviation.
struct Propagated {
  Measured measured;
  FigureBudget budget;
  // Adds an independent contribution.
  void add(ErrorSource kind, double sd);
};

// Fills velocities, restitution, friction, rolling cap and closure of `result`, whose radius is
// known already, and their budgets.
void fill_figures(const ImpactSources& sources, const ImpactOptions& options,
                  ImpactAnalysis& result);

// Puts the figure's budget into the result and gives what was measured.
Measured noted(ImpactAnalysis& result, ImpactFigure figure, const Propagated& propagated);

// When the flight before and the flight after, carried on, are at the same height.
double crossing_of(const ImpactSources& sources, const ImpactSources::Vector& x);

// First-order propagation of the covariances through `figure`.
Propagated propagate(const ImpactSources& sources,
                     const std::function<double(const ImpactSources::Vector&)>& figure);

}  // namespace impactdic::impact
