// Numbers of the fit of greatest likelihood to the lines, and of what is known beforehand. Marks in
// brackets: README.md in this folder.
#pragma once

#include <cstddef>

namespace impactdic::circle {

// fit_lines: rounds of evidence that is linear about a rim, steps within each.
struct LineFitSettings {
  std::size_t least_lines = 24;  // [hand]
  int rounds = 14, steps = 12;   // at most [hand]
  // How far from where the evidence was made it holds, steps of the trace.
  double reach = 0.12, blurred_reach = 0.3;  // [hand]
  // Fewer lines at first.
  int first_stride = 4;            // [hand]
  std::size_t plenty = 400;        // lines; some of them do at first where there are more [hand]
  std::size_t preview_lines = 85;  // that a preview needs [hand]
  int preview_every = 4;           // blocks of lines for one that a first step looks at [hand]
  double share_worth = 100;        // lines whose worth the shares inside the ball count [hand]
  int points_per_parameter = 3;    // at least [hand]
  // What ends steps and rounds, steps of the trace.
  double roughly = 0.03, settled = 5e-4;  // steps within a round: of some lines, of all [hand]
  double close = 0.05;        // a round that ends so near its start holds for a preview [hand]
  double relinearise = 0.03;  // and for a fit [hand]
  double newton = 0.1;        // a step of so much is followed by another like it [hand]
  // Newton's step instead of the kinds' own curvature, by the curvature over that.
  double there = 0.5, convex = 0.25;         // [hand]
  double half_newton = 0.5;                  // of it between the two [hand]
  double fine_from = 0.35, fine_over = 0.4;  // of a fine fit: all of it from 0.75 on [hand]
  // Deviations.
  double common_px = 0.004;   // errors common to an arc [measured] on seeds 1 to 4
  double arcs = 1.2;          // how a sector is misplaced by itself, over all of them together
                              // [measured] on seeds 1 to 4: docs/accuracy/circle.md
  double uneven_chance = 9;   // an uneven width is chance below so many variances [hand]
  double width_prior = 1e-3;  // of the width's equations: settles what is undetermined
};
inline constexpr LineFitSettings kLineFit;

// What is known of a rim beforehand, and tests of its shape.
struct PriorSettings {
  double significant = 18.4;  // χ² with 2 degrees of freedom exceeds it once in 10 000 [definition]
  double plainly_oval = 0.004;  // e/R of a rim that no circle need be tried for [hand]
  double transverse = 0.3;      // of |e|: how far a squashed ball may widen or shrink [hand]
  double round_px = 0.05;       // |e| of a shape too round to have an axis [hand]
  double axis_tilt = 0.1, axis_px = 0.02;  // of |e|, plus px: shape across the given axis [hand]
  double circle_sd_px = 1e-6;              // of a circle's e1 and e2 [definition]: none
  double least_radius_sd_px = 1e-4;  // of a radius that is known [definition]: one is divided by it
};
inline constexpr PriorSettings kPrior;

}  // namespace impactdic::circle
