// The object `impact` of summary.json.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host/impact/impact_phases.h"

namespace impactdic::report {

// What of the request matters to the impact, beside the scale.
struct ImpactSetup {
  double gravity_angle_rad = -kPi / 2;
  std::optional<double> inertia_factor;
};

// Gravity in the track's units where scale and frame rate are known.
impact::ImpactOptions impact_options(const SiScale& scale, const ImpactSetup& setup);

// Instants in frames of the stored file and in seconds of the track's clock; velocities in m/s and
// rad/s, or in px/frame and rad/frame where the scale or the rate is unknown (`units` says which).
// Every figure is {"value", "sd"}; null where it was not measured.
nlohmann::json describe_impact(const impact::ImpactAnalysis& impact,
                               const std::vector<TrackRow>& rows, const SiScale& scale,
                               const ImpactSetup& setup);

// The same in one line for the terminal.
std::string impact_in_a_line(const nlohmann::json& impact);

}  // namespace impactdic::report
