// Grey levels of the background and of the ball's bare paint about a rim. Internal to host/track.
#pragma once

#include "host/circle/rim/rim_cast.h"
#include "host/circle/rim/rim_lines.h"

namespace impactdic::circle {

inline constexpr float kNothing = 0.15f;          // of the contrast, inside the rim
inline constexpr float kGroundTolerance = 0.06f;  // of the contrast

// Finds the levels and leaves only the deep lines that show the ball. False where too few do.
bool find_levels(CastLines& lines, LineTrace::Levels& levels);

// The paint's level at a place, in radii from the centre.
inline float light_at(const std::array<float, 5>& w, float x, float y) {
  return w[0] + w[1] * x + w[2] * y + w[3] * (x * x - y * y) + w[4] * 2 * x * y;
}

}  // namespace impactdic::circle
