// Numbers of the outline: a rim that neither a polarity nor the paint's level tells. Marks in
// brackets: README.md in this folder.
#pragma once

namespace impactdic::circle {

struct OutlineSettings {
  // What is not background differs from it by so many deviations of the noise, plus grey levels.
  float noises = 5, least_level = 1;  // [hand]
  float noises_of_two = 3.5;          // the same where two samples in turn must differ [hand]
  int stretch = 2;  // steps over which what a ray meets first may still grow [hand]
  // Beyond the expected rim, either way, where it is traced.
  double around_px = 8, around_of_r = 0.15;  // [hand]
  int of_usual_rays = 4;                     // one ray for so many of CircleOptions::rays [hand]
  int beside = 2;  // rays on either side whose outer ends tell a ray's background [hand]
  // A plane through what lies at the outer ends of so many rays, or more, that leaves so much of
  // its deviation is the light's [hand].
  int least_across = 12;
  double across = 0.35;
  // Samples of neighbouring rays are pooled over so much of the rim, from samples so far apart, px:
  // the dark side of a ball may differ from the background by less than the noise [hand].
  double pooled_px = 6, apart_px = 1.4;
  int least_beside = 2;         // and at least from so many on either side [hand]
  double least_variance = 0.6;  // of such samples, over the noise's [hand]
  // Evidence of such samples that they are not background: what two free parameters gain by chance
  // is taken off, and no more counts, so that one bright spot is no ball; and what it must come to
  // over some samples inside [hand].
  double chance = 2, most_evidence = 3, least_evidence = 6;
  int within = 6;
  // Evidence of a sample outside that is not background, and the share of such samples that an even
  // background with an obstacle before it does not reach [hand].
  double other_evidence = 1.5, most_uneven = 0.19;
  // Variance of an even background over half of the mean square of what neighbouring samples differ
  // by, most: as in beyond.h, but samples of a ray share pixels. Medians of 1.2 to 1.4 in
  // noise, 1.7 to 6 before wood and tiles.
  double alike = 1.7;       // [measured] light_accuracy random
  int half_level = 4;       // samples inside whose level tells half of the way to it … [hand]
  double clear_noises = 6;  // … where it stands out by so many deviations [hand]
  double support = 0.5;     // share of the rays that must agree [hand]
  double poor_rim = 0.4;    // a rim by its polarity that shows less of itself is doubted … [hand]
  double more_rim = 1.5;    // … and given up for an outline that shows so much more [hand]
  // An outline whose model is not known may be off by so much, px.
  double centre_sd_px = 0.15, radius_sd_px = 0.3;  // [measured] light_accuracy
  // fit_outline: Tukey's constant, in scatters of which this is the least.
  double biweight = 4, least_scale_px = 0.15;  // [hand]
  int passes = 12;                             // [hand]
  double on_rim_px = 1.5;                      // points so near show the rim [hand]
};
inline constexpr OutlineSettings kOutline;

}  // namespace impactdic::circle
