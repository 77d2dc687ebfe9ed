// Numbers of the crossings of the half level along rays, and of the fit through them. Marks in
// brackets: README.md in this folder.
#pragma once

namespace impactdic::circle {

// trace_rim: profiles about the expected rim and where each falls through its half level.
struct CrossingSettings {
  int levels_every = 3;  // rays from one that looks for levels to the next [hand]
  // The sharper of the two kernels errs more with the pixels' phase, the smoother mixes more ink
  // into an edge; px, smooth and sharp.
  float phase_px[2] = {0.006f, 0.02f};  // [hand]
  int least_rays = 16;                  // in view, or nothing is traced [hand]
  float margin_px = 1.5f;  // that samples keep from the picture's edge [definition]: bilinear
  int ground_from = 2, ground_to = 4;  // steps outside the rim that show the background [hand]
  float per_r = 26;  // a step of the deep samples is r over this, at most: 13 reach half
  std::size_t sector_samples = 8;  // of a sector whose bright quantile is believed [hand]
  int newton = 3;                  // steps to the root of a cubic that starts at a straight line's
  float beyond_steps = 2;          // a crossing's background is confirmed so far outside [hand]
  float beyond_noise = 3;          // to so many deviations of the noise [hand]
  // Of the fall over two steps that a Gaussian edge's width is found from, limits of the fall and
  // of the σ in steps. A σ of 0.1 falls by 1, one of 3 by 0.26. [definition]
  double least_fall = 0.3, most_fall = 0.999;
  double least_sigma = 0.1, most_sigma = 3;
  int sigma_halvings = 20;  // to 3e-6 of a step [definition]
};
inline constexpr CrossingSettings kCrossing;

// trace_rim before a background with a texture.
struct UnevenGroundSettings {
  float noises = 2;      // of its scatter within sectors, or it is even [hand]
  double beside_px = 2;  // so far on either side rays tell of a ray's ground [hand]
  // Rays so far apart bend by noise, not by a texture, of which less than so much of their
  // differences is left [hand].
  double apart_px = 1.5;
  float bends = 0.55f;
  // How far outside the edge a slope of the ground is as high as the blur makes it at the edge,
  // steps: twice the mean of a half normal. [definition]
  float outside_steps = 0.6f;
};
inline constexpr UnevenGroundSettings kUnevenGround;

// fit_rim: robust circle or ellipse through the crossings under a mixture of clean, inked and stray
// points.
struct CrossingFitSettings {
  std::size_t least_points = 15;    // three for each of five parameters [definition]
  int learning = 40, refining = 5;  // steps at most [hand]
  int learn_from = 140;             // points at least, where there are as many [hand]
  double first_quantile =
      0.9;  // of the crossings lie inside the first radius: ink moves inwards [hand]
  // The mixture that learning starts from: shares, px.
  double clean = 0.7, inked = 0.29, sigma_px = 0.15, tau_px = 0.5;  // [hand]
  double other_clean = 0.2, other_inked = 0.79;  // of the second start: ink in most edges [hand]
  double most_sigma_px = 1;                      // [hand]
  double explained = 0.7;  // share of the points that a fit takes for the rim's, or another start
                           // is tried [hand]
  double strays_per_px = 0.25;  // density of a stray [definition]: crossings range over 4 px
  double noise_trust = 1.5;     // scatter over the camera's that is taken for noise [hand]
  double common_px = 0.008;     // errors common to an arc [measured]: leaves 0.0015 px of a
                                // centre, as pictures without noise do
  double ink_shift = 2;         // of fine ink, over the scatter it makes [measured]: pattern a3
  // Limits of one step of the mixture's learning: over-relaxed to the power of 1.5.
  double least_ratio = 0.4, most_ratio = 2.5;  // new over old [hand]
  double least_clean = 0.02, least_inked = 0.005, most_share = 0.99, least_strays = 5e-3;  // [hand]
  double least_sigma_px = 0.002, most_step_sigma_px = 1.0;                                 // [hand]
  double sigma_fall = 0.6;                        // new sigma over old, at least [hand]
  double least_tau_px = 0.05, most_tau_px = 2.0;  // [hand]
  double tau_of_sigma = 3;  // depths like the noise could not be told from it [hand]
  // What ends the learning and the refining: shares of sigma, and of the points.
  double learnt = 0.05, learnt_share = 0.02, refined = 0.01;  // [hand]
  // Beyond so many sigmas a normal density is 0, and below so many its ratio to the skewed one is
  // no longer computed from it. [definition]
  double most_z = 8, least_a = -4;
};
inline constexpr CrossingFitSettings kCrossingFit;

}  // namespace impactdic::circle
