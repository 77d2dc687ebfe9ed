// Numbers of the rim model (ink and edge) and of how it is learnt. Marks in brackets: README.md in
// this folder.
#pragma once

namespace impactdic::circle {

// RimTexture: moments of the ball's ink, kind by kind. Levels are shares of the contrast: 0 the
// background, 1 bare paint.
struct TextureSettings {
  float dark = 0.3f, bright = 0.85f;  // levels apart [hand]
  float bare_noise = 3.5f,
        bare_least = 0.02f;  // bare paint lies so near 1: noises, plus level [hand]
  // Levels beyond are cut off: glints and dead pixels, and what evening a texture leaves [hand].
  float least = -1.5f, least_evened = -0.3f, most = 1.5f;
  // What a kind looks like before any window was seen: inner and outer level, and a covariance
  // typical_variance · exp(−decay · samples apart). Kinds as in kKindOf.
  double inner[8] = {1, 0.4, 0.95, 0.15, 0.6, 0.95, 0.5, 0.95};  // [hand]
  double outer[8] = {1, 0.15, 0.15, 0.6, 0.6, 0.6, 0.95, 0.95};  // [hand]
  double variance = 0.03, decay = 0.4;                           // [hand]
  double worth = 8;  // windows whose worth the typical counts [hand]
  double bare_worth = 4, kind_worth = 0.5,
         all_worth = 8;    // the same of the shares [definition]:
                           // half of the windows are bare, a 16th of each other kind
  double paint_sd = 0.01;  // of the level of bare paint from place to place [hand]
};
inline constexpr TextureSettings kInk;

// RimModel: what a line's samples scatter by beside ink and noise.
struct RimModelSettings {
  double ground_sd = 0.004;  // of the background's level, share of the contrast [hand]
  double width_sd = 0.08;    // of ln σ of the edge from line to line [hand]
  double stray = 0.01;       // share of lines that have nothing to do with the rim [hand]
  double blurred = 0.06;     // noise through which a rim is found from afar, of the contrast [hand]
  double kernel_px = 0.9;  // along the normal for one along a row or column [definition]: the mean
                           // of cos φ from 0 to 45°, to a hundredth
};
inline constexpr RimModelSettings kRimModel;

// learn_rim: texture and width of the edge from a rim that is known already.
struct LearningSettings {
  int traces = 6, widths = 5;  // at most [hand]
  // First σ from the search's: that mixes the steepest slope with noise and ink.
  double sigma_of_blur = 0.8, least_sigma_px = 0.6;  // [hand]
  // A sphere's edge that is so much wider, and makes a line's ln p so much likelier, is the right
  // one [hand].
  double wider_edges[2] = {1.35, 1.7}, likelier_wider = 0.05;
  double most_change = 0.3;  // of ln σ from trace to trace [hand]
  double most_asked = 0.2;   // of ln σ from fit to fit [hand]
  double overshoot = 1.5;    // of the change asked for: it asks for less than is missing [hand]
  double settled = 0.01;     // of ln σ [hand]
  // Whether the model holds.
  double misfit = 20;       // RimModel::misfit at most; 7 where the model holds exactly [hand]
  double explained = 0.7;   // share of the lines that must have to do with the rim [hand]
  double agree_sds = 5;     // of the crossings, between the two kinds of fit … [hand]
  double apart_px = 0.015;  // … and so much beyond [hand]
  double most_shift = 0.4;  // of σ: what ink may shift the crossings [hand]
  // How far the model misplaces the rim. The ball is foreshortened towards its rim, so that its ink
  // there is finer than where the model is learnt. That misplaces the rim about as a misjudged
  // width of the edge would, by so much of ln σ.
  double model_error = 0.06;  // [measured] on seeds 1 to 4: docs/accuracy/circle.md
  double uneven_error = 0.5;  // of the amplitude of an uneven width [measured] on seeds 1 to
                              // 10 of light_accuracy's disc_blur
  // Ink that is learnt from a picture noisier than those, by the noise as a share of the contrast,
  // and from the few pixels of a small ball, over its radius cubed, likewise. [measured] on balls
  // 1 to 40 of e1 under noise 8 and in 30 % of the light, and on 11 to 16 of 30 px:
  // docs/log/accuracy.md, "Discs in noise".
  double of_noise = 3.7, of_small_px3 = 2550;
  // What the crossings' radius differs by from the model's, beyond so much, px, the model errs by
  // to this share, where ink makes the radius that uncertain, px; to less of it where it does not.
  // [measured] whole discs of the sixteen patterns, seeds 1 to 3, blur 0.6, 0.8, 1.0 and 1.4 px:
  // docs/log/accuracy.md, "Fine and dense ink".
  double usual_apart_px = 0.06, of_apart = 0.4, uncertain_px = 0.01;
  // Of a rim of hairs no line shows bare paint, neighbours err alike (`wider` of `inflation`), and
  // crossings lie far inside it, to a share of which it is misplaced. [measured] four furry balls:
  // 0 to 0.009 bare, wider by 2.3 to 7.5; of fine dots 0 to 0.03, by 1.0 to 2.8 where hardly any is
  double hardly_bare = 0.02, alike_from = 1.5, alike_over = 1, of_hairs = 0.7;
  // Of a disc of whose rim a part is hidden or lies before a texture, over the radius squared: its
  // ink is learnt from what is left, and what adjoins the gap is no rim. [measured] light_accuracy
  // disc_unseen and disc_unseen_60, balls 1 to 60
  double arc_centre_px3 = 75, arc_radius_px3 = 120;
  // By how much more noise does so to single arcs. [measured] on balls 1 to 6 of e1 under noise 8
  // and in 30 % of the light.
  double noise_in_arcs = 2.8;
  double usual_noise = 0.0125;       // noise 2, white 190, background 30 [definition]
  double least_place_sd_px = 0.001;  // [hand]
  // By less ln σ moves the rim of one in three whole discs, by chance: beside a bar it came out as
  // a quarter of this, and errors were 6 deviations. A rim is whole that shows so much of itself:
  // whole discs 0.77 and more, those behind bars of 30 % at most 0.53.
  double least_moved_px = 0.18;  // [measured] light_accuracy disc, disc_noise, disc_unseen_60
  double whole_rim = 0.6;        // [measured] light_accuracy disc_bar, CircleAccuracy
  double wider = 0.05;           // of ln σ, to see what the width does [definition]: a difference
};
inline constexpr LearningSettings kLearning;

}  // namespace impactdic::circle
