// Numbers by which a measured circle is believed or measured again, in one frame and over frames.
// Marks in brackets: README.md in this folder.
#pragma once

#include <cstddef>
#include <cstdint>

namespace impactdic::circle {

// measure_circle.
struct JudgementSettings {
  double in_view = 0.35;    // less of the rim than this in the picture: out of view [hand]
  double least_arc = 0.12;  // share of the rim's sectors that must hold points [hand]
  int least_points = 24;    // [hand]
  // By the crossings.
  int traces = 4;           // at most [hand]
  double dense = 0.6;       // share of inked points from which a sharp kernel is better [hand]
  double retrace_px = 0.1;  // a fit farther from its rays' rim is traced again: what is linear
                            // then errs by 4e-5 px at R = 115 px [definition]
  int preview_of_rays = 3,
      preview_rays = 64;         // one of so many rays, and at least, in a preview [hand]
  double least_search_px = 0.3;  // scatter of a prediction that has to be searched about [hand]
  double on_rim_px = 3;          // crossings so near show the rim [hand]
  double gap_deg = 20;           // gaps that ink makes are narrower [hand]
  // Where no model of the rim tells. A circle that shows no more than so much of its rim, or whose
  // clean points scatter by so much, px, is looked for again, in so much of its radius; another one
  // is the ball's whose rim that shows is so much longer and that lies so far off, px [hand].
  double much_rim = 0.6, scattered_px = 1, wider_of_r = 0.06, more_rim = 1.1, another_px = 1;
  // A rim of which more shows, and whose clean points scatter by less, px, is not looked for again,
  // nor measured again where a proof has found it [hand].
  double clean_rim = 0.5, clean_px = 0.1;
  double pressed_long = 0.02;  // of the radius: how far the long axis of a ball in contact may be
                               // from it [hand]
  // Shapes of a ball in contact that are looked for, as e/R: so far apart, and so much beyond the
  // last one [hand].
  double shapes_apart = 0.02, pressed_more = 0.06;
  double of_apart =
      0.7;  // of what crossings say otherwise than its rim model, in its deviation [hand]
  // Of circles whose clean points scatter by more, widths of the edge, or by so much where little
  // of the rim shows, half are wrong: what they err by on the mean, share of the radius.
  // [measured] light_accuracy random 3001 3320
  double usual_px = 1.3, ragged = 0.75, ragged_arc = 0.23, ragged_sd_of_r = 0.08;
  // What inked crossings err by over what they state. [measured] discs of seven patterns, 30 to 115
  // px, also behind a bar, in noise and before tiles, rms of 29: 1.2 and 1.7; the worst 2.1 and 2.5
  // (e2, f2)
  double inked_centre = 1.3, inked_radius = 1.7;
  // What crossings err by beside that where no rim model holds, and more where an arc is cut from
  // the rim, by the radius; the centre goes with the radius by so much there (0.9 to 1.9; before
  // textures and of inked rims by 0.7 at most). [measured] discs of sixteen patterns, 30 to 115 px,
  // 30 % hidden
  double crossed_px3 = 45, cut_arc_px = 0.12, cut_arc_px3 = 100, cut_with_r = 0.8;
  double inked_px = 0.1;  // scatter from which on it is a texture's: before wood they lack nothing
  // By the rim model; steps are those of the lines.
  int follow_traces = 3;        // at most [hand]
  double retrace_steps = 0.2;   // a fit farther from its lines' rim is traced again [hand]
  double followed_steps = 1.5;  // a rim farther from its prediction is searched [hand]
  int preview_of_lines = 3;     // of so many lines one is enough for a preview [hand]
  double close_steps = 0.8;     // that a prediction may scatter to be followed … [hand]
  double near_steps = 0.15;     // … and to need no preview [hand]
  double followed_oval = 0.01;  // e/R of a prediction, no more: a ball under strong compression
                                // changes its shape from frame to frame [hand]
  // Share of what the rim showed beside this frame, at least. Lines find nothing wrong where a ball
  // that is compressed at once has left the circle: they end in the background.
  double followed_rim = 0.85;  // [hand]
  double noisier = 2;          // than when the model was learnt: learn again [hand]
  double followable = 0.9;     // share of the lines that must have to do with the rim where no
                               // search confirms it [hand]
  // What crossings of an edge that is wider than this misplace the rim by, as a share of what it is
  // wider by. [measured]: docs/log/accuracy.md, "Discs that are known to be discs"
  double sharp_px = 1, of_blur = 0.1, of_blur_centre = 0.065;
  // Runs of lines that show something else outside: obstacles make few, a background with a texture
  // more [measured] (bars at most 2, wood and tiles 14 to 32); what that misplaces a rim by.
  int texture_breaks = 6;
  double texture_px = 0.022, texture_radius_px = 0.009;
  // What a background that rises by its contrast over the radius moves the centre by, over what the
  // rim's place is known to; and where crossings alone tell it, px. [measured] discs of six
  // patterns, 60 px, 0.15 to 0.5 grey levels a pixel; the second bright and dark spheres
  double of_rise = 4.6, crossed_of_rise_px = 0.4;
  // A level so near the end of the camera's scale is cut off [hand]; what that may do to the
  // radius, over the edge's width [measured]: white one half beyond the scale.
  double over_exposed = 0.985, over_exposed_sd = 0.25;
  // Of a level that is an average: some places may reach the end. What of that lies on one side:
  // ink hides where it does [hand].
  double nearly_over_exposed = 0.8, cut_off_aside = 0.25;
};
inline constexpr JudgementSettings kJudge;

// BallTracker.
struct TrackingSettings {
  std::size_t radii = 101;       // frames over which the radius is learnt [hand]
  std::size_t least_radii = 3;   // [hand]
  double whole_rim = 0.3;        // share of the rim that a radius is learnt from [hand]
  double mad = 1.48;             // σ over the median of a normal deviate's size [definition]
  double radius_sd_of_r = 2e-4;  // the ball's distance from the camera may change a little [hand]
  // Scatter of a prediction: px, and of the velocity (an impact apart).
  double steady_px = 0.3, steady_of_step = 0.05;  // from two frames [hand]
  double bend_sd_px = 0.3;  // from three that a steady force bends, by their errors: no more [hand]
  double first_px = 3, first_of_r = 0.05;  // from one [hand]
  // Steps that differ by so much, px, and at most so much of the radius, are those of a ball that
  // falls in slow film: the next step differs by as much [hand]. An impact's differ by more.
  double falls_px = 4, falls_of_r = 0.5;
  double rim_px = 0.3, rim_of_r = 0.005;  // of the shape [hand]
  double back_sds = 3;  // scatters from where the frames after it put a first frame's ball [hand]
  // On the way between two frames: px, and of the second one's distance from its prediction, of
  // which a parabola's arrow is an eighth; where the bend is known, half of that [hand].
  double between_px = 0.05, of_off = 0.125, of_off_bent = 0.0625;
  // Before the whole picture is searched: px, over what was predicted; then as a share of the
  // radius, for in slow film gravity changes a step by a third of it [hand].
  double lost_px = 3, lost_factor = 3, lost_of_r = 0.15;
  double found_sd_px = 1;  // of find_ball's circle [hand]
  // Of a ball that is found anew: share of the rim in view, at least; share that leaves no doubt,
  // and with less e/R and the distance from the known radius, at most [hand]. Arms and shadows of a
  // filmed clip had 0.05 to 0.3 of a rim, or were ovals of 0.15.
  double found_rim = 0.25, plain_rim = 0.6, found_oval = 0.1, found_radius = 0.15;
  // Of a circle drawn by hand: deviation of each of its figures, px and as a share of the radius,
  // the larger [hand]; a ball whose centre is expected or measured farther from it than this share
  // of the radius is another one [hand].
  double hand_px = 1, hand_sd_of_r = 0.02, hand_of_r = 0.5;
  std::int64_t longest_gap = 5;   // frames without a ball before the picture is searched [hand]
  double radius_tolerance = 0.2;  // of the radius: another circle, not this ball [hand]
  // As large as the ball's last one, or its usual one, at most, less so many of its deviations.
  double most_growth = 1.06, growth_sds = 2;  // [hand]
  // Frames left behind one that is measured ahead; fewer where that does not lie as predicted.
  std::size_t run = 16, shortest_run = 4;  // [hand]
  // From the prediction, px; the frames between then lie within an eighth of it from a line.
  double straight_px = 2.5;  // [hand]
  std::int64_t learn_every =
      256;  // frames from one vain attempt to learn the rim to the next [hand]
};
inline constexpr TrackingSettings kTracking;

}  // namespace impactdic::circle
