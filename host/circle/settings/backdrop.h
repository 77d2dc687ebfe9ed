// Numbers of what lies behind the ball. Marks in brackets: README.md in this folder.
#pragma once

#include <cstddef>

namespace impactdic::circle {

// Backdrop: the background's texture, learnt from frames in which the ball lies elsewhere.
struct BackdropSettings {
  // Learnt from: with fewer a frame's noise would be taken for texture, more would take long
  // [hand].
  std::size_t least_views = 4, most_views = 16;
  std::size_t most_bytes = 1u << 27;  // of frames kept for it: as many as fit, or none [hand]
  // A pixel so far outside the rim shows no ball: a rim that is roughly known, or well; and so far
  // outside, frames are asked for their median.
  double rough_px = 3, clear_px = 1.2, well_clear_px = 4;  // [hand]
  // What no frame has shown goes on as a plane through so much of what is known about it, so far.
  int plane_half_px = 4, plane_least = 12;  // [hand]
  double plane_px = 3;                      // [hand]
  int spread_px = 24;       // what no frame has shown is taken from so near, at most [hand]
  int beside_px = 16;       // so far beside the rim a texture matters [hand]
  int around_px = 15;       // side of the square over which texture is judged [hand]
  double noises = 1.0;      // of noise's deviation: a texture that matters is stronger … [hand]
  double of_range = 0.008;  // … by so much of the camera's scale [hand]
  // Of so many views a look at each by itself tells first, from so much of that roughness on
  // [hand].
  std::size_t looked_at = 4;
  double may_be = 0.5;
  // What hides the ball stands still, too: behind it lies nothing that could be evened. Within the
  // ball, beside its rim, it looks as it does outside.
  double same_noises = 4;     // levels that are the same differ by so many deviations [hand]
  double most_hidden = 0.04;  // of the rim, or nothing is evened [hand]
  // Texture so far from the even level, in levels that are the same, is plain; under the rim, so
  // deep, share of the radius, no more of it shows than so much.
  double plain_levels = 2, deep_of_r = 0.4, most_through = 0.7;  // [hand]
  // More of what the views show is not what was learnt: the background moves [hand]; 0.1 beside a
  // shadow that moves, 0.004 at most before tiles, paper, a floor, strings.
  double most_changing = 0.03;
  // Where no ball was plainly seen: a disc that moved fills so much of the hull of what moved.
  // Shares of its radius: what that is right to, its scatter about the ball, how far about it all
  // of the ball lies, tried in turn, and how near it a ball is the one that moved.
  double moved_round = 0.65, moved_within = 0.2, moved_sd = 0.04;  // [hand]
  double moved_beyond[2] = {0.1, 0.3}, as_moved = 0.1;             // [hand]
  // The ball is believed that then shows so much of its rim, or so much about the disc that moved,
  // with e/R no more than that, in so many views.
  double plain_rim = 0.6, as_moved_rim = 0.35, plain_oval = 0.1;  // [hand]
  int plain_views = 3;                                            // [hand]
  // What was seen with less of its rim is looked for so, too; and what in more than so many of the
  // views lies in a disc that moved, and is smaller than so much of it: a mark.
  double seen_rim = 0.5, mostly = 0.5, mark_of_r = 0.5;  // [hand]
  int learnings = 3;  // of the background, each by circles measured before what was learnt [hand]
  // Evening about a circle, which is measured again where it has moved by more.
  // Inside the rim all of the texture is taken away, and so far again less and less [hand].
  double inside_px = 4;
  double settled_px = 1;   // [hand]
  double less_rim = 0.7;   // of the rim that carried the fit before: it was the better one [hand]
  double least_rim = 0.3;  // share of the rim that must carry a fit without a model of it [hand]
  // What a learnt background misplaces the circle by, and one that is guessed all around, px, of a
  // ball of such a radius; larger ones by the root less. [measured]: docs/log/accuracy.md, "Before
  // wood and tiles", and light_accuracy sphere_wood and sphere_wood_far, balls 1 to 60.
  double evened_sd_px = 0.06, guessed_sd_px = 0.12, evened_of_r_px = 60;
  double much_guessed = 0.05;  // of the rim: no circle is exact that no model holds for [hand]
  int rounds = 3;              // of measuring, at most [hand]
};
inline constexpr BackdropSettings kBackdrop;

}  // namespace impactdic::circle
