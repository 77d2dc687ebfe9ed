// Of what a pattern is made, whatever it is painted on. Internal to the painters.
#pragma once

#include <vector>

#include "sim/speckle/pattern.h"
#include "sim/speckle/placement.h"

namespace impactdic::sim::speckle {

inline constexpr double kSpeckleGap = 1.7;  // closer speckles show as one, px
inline constexpr double kLineWidth = 2;     // (f), px

// Radius of the disc whose picture is darker than half level over `area_px`.
double disc_radius_for(double area_px);

// A speckle of random shape about an origin: each disc overlaps one before it; of the wanted area.
std::vector<InkDisc> make_cluster(double area_px, Random& random);

// Areas of `count` speckles, largest first: lognormal of exactly the stated mean, or log-uniform
// (stratified, so that their sum hardly scatters).
std::vector<double> draw_areas(const PatternSpec& spec, int count, Random& random);

// Expected area of a speckle, px².
double mean_area(const PatternSpec& spec);

}  // namespace impactdic::sim::speckle
