// Numbers of the outline: a rim that neither a polarity nor the paint's level tells. Marks in
// brackets: README.md in this folder.
#pragma once

namespace impactdic::circle {

struct OutlineSettings {
  // What is not background differs from it by so many deviations of the noise, plus grey levels.
  float noises = 5, least_level = 1;  // [hand]
  float noises_of_two = 3.5;          // the same where two samples in turn must differ [hand]
  int beside = 2;         // rays on either side whose outer ends tell a ray's background [hand]
  double support = 0.5;   // share of the rays that must agree [hand]
  double poor_rim = 0.4;  // a rim by its polarity that shows less of itself is doubted … [hand]
  double more_rim = 1.5;  // … and given up for an outline that shows so much more [hand]
  // An outline whose model is not known may be off by so much, px.
  double centre_sd_px = 0.15, radius_sd_px = 0.3;  // [measured] light_accuracy
  // fit_outline: Tukey's constant, in scatters of which this is the least.
  double biweight = 4, least_scale_px = 0.15;  // [hand]
  int passes = 12;                             // [hand]
  int stretch = 2;  // steps over which what a ray meets first may still grow [hand]
};
inline constexpr OutlineSettings kOutline;

}  // namespace impactdic::circle
