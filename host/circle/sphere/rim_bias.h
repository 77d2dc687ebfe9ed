// By how much a sphere's rim is measured too large in every frame alike, told by its turns.
// Internal to host/circle and those who know the body.
#pragma once

#include <impactdic/measured.h>

#include <array>
#include <optional>
#include <span>

#include "host/circle/circle.h"

namespace impactdic::circle {

// Light and foreshortened ink that are not as a rim model has them misplace the rim of all frames
// that it is used in, and leave no trace in their scatter. What they do shows where the radius is
// known from elsewhere.
struct RimBias {
  RimBias() = default;
  // From and to plain numbers, bit for bit. Throws InvalidArgument where they are no bias.
  explicit RimBias(const std::array<double, 4>& numbers);
  std::array<double, 4> numbers() const;

  double off_px = 0;        // of the radius, as far as the difference tells
  double shared_sd_px = 0;  // that circles state for it (CircleFit::shared_r_sd_px)
  double chance_sd_px = 0;  // of the difference, had the rim no such error
  bool lit = false;         // of rim models that know light, or of those that do not
};

// From radii of frames that share a rim model, one of their fits, and the outline's radius by the
// ball's turns. nullopt where the fit is none by a rim model. Where the two differ by more than
// both state either may be wrong, and both are taken to be known to no more than that.
std::optional<RimBias> rim_bias(std::span<const double> radii_px, const CircleFit& like,
                                const Measured& by_turns);

// Takes it off a circle's radius, and what is known by it off the deviation (both are normal). The
// centre stays: how light bends a rim is not told by its radius. So do circles that were measured
// otherwise than those that told it.
void take_off(const RimBias& bias, CircleFit& fit);

}  // namespace impactdic::circle
