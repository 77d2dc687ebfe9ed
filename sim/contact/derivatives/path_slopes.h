// Derivatives of a body's path by numbers of its job: what a fit to a measured path asks for.
#pragma once

#include <impactdic/impact_model.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace impactdic::sim::contact {

// Of place and angle at each instant by each number, instants x numbers, row-major; of a shell the
// place of its outline. Lengths in metres, angles in radians, over the number's own unit.
struct PathSlopes {
  std::vector<double> t, n, angle;
};

// By the numbers of these keys of a job file, along the `path` that simulate_impact has found at
// the same `times_s`, ascending. Nothing for two bodies, where a number is none that the job's laws
// read, and where the motion has no derivative or cannot be followed with it.
std::optional<PathSlopes> path_slopes(const ImpactJob& job, std::span<const double> times_s,
                                      std::span<const std::string> keys,
                                      std::span<const TrajectoryPoint> path);

}  // namespace impactdic::sim::contact
