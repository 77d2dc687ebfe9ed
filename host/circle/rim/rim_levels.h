// Grey levels of the background and of the ball's bare paint about a rim: the model that both ways
// to trace a rim share. Internal to host/circle.
//
//   background  a level for each of kLevelSectors sectors, linear between their middles
//   paint       w0 + w1 x + w2 y + w3 (x² − y²) + w4 2xy, the place in radii from the centre
//   contrast    the paint's level at a point of the rim less the background's there
//
// Both find the paint as an upper envelope of sectors that settles on the crowd about it, by the
// numbers of settings/levels.h, and judge by the functions below. Rays (rim_edge.cpp) and lines
// (rim_levels.cpp) find the coefficients by code of their own. The two cannot be one without a
// change of results:
//   - quantiles: rays take exact order statistics, lines bisect to a tolerance, which is several
//     times quicker for the thousands of samples of every frame;
//   - background: rays take the median of three sectors' samples 2 … 4 steps outside, lines the
//     mean of what lies near the middle of three sectors' medians, from the outermost sample alone;
//   - paint: rays sample 3, 5 … 13 steps inside and carry each level along the light's slope to the
//     middle of its ray, lines sample 4 … 11 steps inside and take each at the middle;
//   - equations: rays sum levels and solve by L D Lᵀ, lines sum distances from the level before and
//     solve by L Lᵀ, a part of the sums in single precision.
#pragma once

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "host/circle/rim/rim_cast.h"
#include "host/circle/rim/rim_lines.h"
#include "host/circle/settings/levels.h"

namespace impactdic::circle {

// The paint's level at a place, in radii from the centre.
inline float light_at(const std::array<float, 5>& w, float x, float y) {
  return w[0] + w[1] * x + w[2] * y + w[3] * (x * x - y * y) + w[4] * 2 * x * y;
}

// Half widths of the windows in which the paint's level settles, one after the other.
inline std::array<float, 3> settling_windows(float contrast, float noise) {
  const float last = std::max(kLevels.window_noise * noise, kLevels.window_least * contrast);
  return {std::max(kLevels.window_first * contrast, last),
          std::max(kLevels.window_next * contrast, last), last};
}

// Weight that holds coefficient `m` of the paint to a paint without shading.
inline double no_shading(int m) { return kLevels.no_shading[m == 0 ? 0 : m < 3 ? 1 : 2]; }

// Noise of a sample from how samples differ from neighbour to neighbour; at least one.
inline float noise_of_steps(std::span<const float> steps) {
  return kLevels.noise_per_median / std::sqrt(2.0f) * quantile(steps, 0.5);
}

// The background between the middles of two sectors of levels `a` and `b`, the share `t` of the way
// on: linear, or where an obstacle ends between them the one nearer to what is `seen` outside.
inline float ground_between(float a, float b, float t, float seen, float contrast) {
  if (std::abs(a - b) < kClear.ground_tolerance * contrast) return a + t * (b - a);
  return std::abs(seen - a) < std::abs(seen - b) ? a : b;
}

// Directions of the middles of sectors, rad: of rays, which share the circle evenly from 0 on; of
// lines, which share its quarters from −45° on by the tangent.
double middle_of_rays(int sector);
double middle_of_lines(int sector);
// Where the background's level rises evenly; an obstacle's does not. `ground`: sector by sector,
// whose middles lie at `middle`.
GroundRise rise_of_ground(const std::array<float, kLevelSectors>& ground, float contrast,
                          double (*middle)(int sector));

// Background is `seen` outside, and the ball can be told from it.
inline bool is_clear(float contrast, float usual_contrast, float seen, float ground, float noise) {
  return contrast > kClear.least_contrast * usual_contrast &&
         contrast > kClear.contrast_noise * noise &&
         std::abs(seen - ground) < kClear.ground_tolerance * contrast + kClear.ground_noise * noise;
}

// Finds the levels and leaves only the deep lines that show the ball. False where too few do.
bool find_levels(CastLines& lines, LineTrace::Levels& levels);
// The same of a sphere.
bool find_sphere_levels(const Frame& frame, const Rim& rim, const LineRequest& request,
                        const CastLines& lines, LineTrace::Levels& levels);
// A sphere's light at the rim, in directions evenly around it.
std::array<double, kLevelSectors> levels_at_rim(const SphereLight& light);
// Whether a part of the rim is lit so little that its paint cannot be told from the background, or
// is darker.
bool fades(const LineTrace::Levels& levels);
// The background at each line from the lines' outermost samples.
void grounds_at(const CastLines& lines, const std::array<float, kLevelSectors>& levels,
                float contrast, std::vector<float>& out);

}  // namespace impactdic::circle
