// Numbers of the grey levels about a rim and of the lines and rays that find them. Both ways to
// trace a rim (rays of rim_edge, lines of rim_lines) use the same ones. Marks in brackets:
// README.md in this folder.
#pragma once

#include <algorithm>

namespace impactdic::circle {

// Steps of the samples along rays and lines.
struct StepSettings {
  double sharpest_px = 0.75;  // σ; a wider edge is sampled on proportionally wider steps [hand]
  double per_r = 8;           // a step is at most the radius over this [hand]
};
inline constexpr StepSettings kSteps;

// Samples lie so far apart, px, across an edge of width `sigma_px` of a rim of radius `r_px`.
inline double step_px_of(double sigma_px, double r_px) {
  return std::clamp(sigma_px / kSteps.sharpest_px, 1.0, r_px / kSteps.per_r);
}

// The levels of background and bare paint. The paint's is a quadratic in the place, by an upper
// envelope of sectors (asymmetric least squares; Newey and Powell, 1987) that settles on the crowd
// about it.
struct LevelSettings {
  float noise_per_median = 1.4826f;  // σ over the median of a normal deviate's size [definition]
  double bright = 0.95;        // of a sector's samples lie below its first level of the paint: on a
                               // densely inked ball little more shows the bare paint [hand]
  int envelope_passes = 6;     // at most [hand]
  double below = 0.02;         // of the contrast: a sector so far below the envelope is dark [hand]
  double below_weight = 0.03;  // of a dark sector: a bar darkens whole sectors [hand]
  // Weights of a paint without shading, for the constant, the linear and the quadratic terms, in
  // sectors: no shading unless it shows.
  double no_shading[3] = {1e-6, 0.1, 1};  // [hand]
  // The crowd lies within these windows one after the other, shares of the contrast, and never
  // within less than the last two: deviations of the noise, share of the contrast.
  float window_first = 0.08f, window_next = 0.04f;   // [hand]
  float window_noise = 2.5f, window_least = 0.015f;  // [hand]
  // Share of the background's variance about a rim that a plane makes where light falls off across
  // it [hand].
  double rises_evenly = 0.88;
  double held = 5;  // samples whose worth the level before counts: sectors without bare
                    // paint keep theirs [hand]
};
inline constexpr LevelSettings kLevels;

// Of find_levels alone, which finds quantiles to a tolerance.
struct LineLevelSettings {
  std::size_t least_deep = 5;    // deep lines: as many as the paint has coefficients
  float rise_rank = 0.9f;        // of the lines' rises lie below the usual one [hand]
  float rise_tolerance = 0.01f;  // of the greatest rise [hand]
  float bright_noise = 0.25f,
        bright_least = 0.02f;                   // tolerance: of the noise, plus grey levels [hand]
  float ground_noise = 3, ground_least = 0.5f;  // half window about the background's middle: of the
                                                // noise, plus grey levels [hand]
  float ground_tolerance = 0.125f;              // of that half window [hand]
  float least_contrast = 1e-6f;                 // grey levels: nothing is divided by 0 [definition]
  // Lines so far apart differ by so much more than those side by side where the noise of pixels
  // that touch is alike, and by so little less than those twice as far apart [hand].
  std::size_t noise_apart = 4;
  float noise_alike = 1.4f, noise_even = 1.1f;
};
inline constexpr LineLevelSettings kLineLevels;

// What shows background outside and ball inside.
struct ClearSettings {
  float least_contrast = 0.2f;     // of the usual contrast [hand]
  float contrast_noise = 6;        // and deviations of the noise [hand]
  float ground_tolerance = 0.06f;  // of the contrast, between what is seen outside and the
                                   // background's level, or between two sectors alike [hand]
  float ground_noise = 4;          // plus so many deviations of the noise [hand]
  float nothing = 0.15f;           // of the contrast: less inside the rim is no ball [hand]
  float nothing_noise = 5;         // deviations of the noise, likewise [hand]
  int beside = 3;  // rays or lines that the blur of an obstacle beside them reaches [hand]
  // Share of the rim: gaps that ink makes are narrower [hand]. Lines beside a wider one, which
  // something as bright as the background makes: what is learnt from them reaches behind it
  // [measured] on balls 1 to 20 of e1, 60 px.
  float gap_of_rim = 1.0f / 12;
  int beside_hidden = 9;
};
inline constexpr ClearSettings kClear;

// trace_lines and cast_lines.
struct LineSettings {
  int least_lines = 16;      // in view, or nothing is traced [hand]
  int deep_every = 4;        // lines from one that reaches deep to the next … [hand]
  int deep_all_up_to = 400;  // … where more than so many are cast: a hundred or two do [hand]
  float least_noise =
      0.003f;  // of the contrast: a picture without noise is one of whole grey levels [hand]
  float deep_per_r = 24;       // a step of the deep samples is r over this, at most: 11 reach half
  float last_turn = 0.99999f;  // of a quarter: an angle stays in its own [definition]
  // Pixels beside a sample that its cubic needs: 2, and no less after rounding. [definition]
  float least_v_px = 1, most_v_px = 2.01f;
};
inline constexpr LineSettings kLine;

}  // namespace impactdic::circle
