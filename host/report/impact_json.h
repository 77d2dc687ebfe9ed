// The object `impact` of summary.json.
#pragma once

#include <impactdic/impact.h>

#include <nlohmann/json_fwd.hpp>

namespace impactdic::report {

// Every figure is {"value", "sd"}; null where it was not measured. Velocities are in m/s and rad/s,
// or in px/frame and rad/frame where the scale or the rate is unknown (`units` says which).
nlohmann::json describe_impact(const ImpactFigures& impact);

// Back from there, as far as shots.csv needs it: status, instants, velocities, figures and verdict.
// Throws nlohmann::json::exception where `described` is nothing of the kind.
ImpactFigures read_impact(const nlohmann::json& described);

}  // namespace impactdic::report
