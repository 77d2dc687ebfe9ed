// Numbers of what shows of a ball outside a rim. Marks in brackets: README.md in this folder.
#pragma once

namespace impactdic::circle {

struct BeyondSettings {
  double reach_of_r = 0.4, least_reach_px = 12;  // that is looked at, from the rim outwards [hand]
  // Left out beside the rim: px, and widths of the edge, of which one side's tail ends by then.
  double beside_px = 1.5, beside_sigmas = 2;  // [hand]
  double ring_px = 2, rings = 16;  // width of a ring, at least; of more there are so many [hand]
  double apart_px = 1;             // samples along a ring [hand]
  int least_samples = 3, most_samples = 12;  // of a ring in one direction [hand]
  double usual_sigma_px = 1;                 // width of an edge that was not measured [hand]
  int background_rings = 3;  // or a third of all: the outermost are the background [hand]
  // What is not background: deviations of a mean from it, plus grey levels; deviations by which
  // its scatter exceeds the noise's variance.
  double of_mean = 5, least_level = 0.5, of_scatter = 6;  // [hand]
  // A coder of video smooths noise away: half of the mean square of what neighbouring pixels differ
  // by is less than the first of these, and the variance about the ball less than the second. About
  // what moves it leaves patches of other levels, up to such a share of the ball's contrast, which
  // is told so deep inside. [measured] bench/coded_film.py
  double smoothed = 0.25, plain = 0.7, of_contrast = 0.04;
  double inside[3] = {0.6, 0.75, 0.9};  // of the radius [hand]
  // A background may grow brighter outwards by so much of the ball's contrast, over all rings, or
  // by so much more than its levels on all sides tell: what is steeper is not the background's
  // [hand].
  double most_slope = 0.1;
  double less_scatter = 0.7;  // of that about one level: plainly brighter outwards, or not [hand]
  // An even background: its means scatter by no more than so many times what its noise makes of
  // them, and no more of it than this differs from its level, as beside an obstacle's edge.
  double even = 3, most_uneven = 0.19;  // [hand]
  // Its variance over half of the mean square of what neighbouring pixels differ by: 0.9 to 1.15 in
  // noise, 1.8 and more before wood, tiles, in compressed film. [measured] light_accuracy random
  double alike = 1.4;
  // A shadow that the ball casts lies in no more of the directions, leaves in one no more of the
  // background's light, and grows brighter outwards in most of them; without a texture: a cell
  // scatters by no more than so much of what those about it differ by [hand].
  double shadow_share = 0.65, shadow_darker = 0.93, shadow_most = 0.8, shadow_smooth = 0.25;
  int least_told = 8;  // directions [hand]
  double share = 0.1;  // of them that no chance explains [hand]
  // A circle that shows so much of its rim is a rim, whatever lies beside it [hand].
  double whole_rim = 0.8, whole_residual_px = 0.5;
  // What shows outside another rim must be less than so much of it [hand].
  double less = 0.5;
  // A model of a rim that was hidden from the first look may misplace it by so much, px.
  double hidden_sd_px = 0.04;  // [measured] light_accuracy disc_unseen_60
  double support = 0.3;        // share of the rays that must agree on it [hand]
  double most_of_r = 0.05;     // share of the radius that a circle may be off [hand]
  double look_of_r = 0.1;  // scatter of where the ball is looked for, share of the radius [hand]
};
inline constexpr BeyondSettings kBeyond;

}  // namespace impactdic::circle
