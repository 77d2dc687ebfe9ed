// Numbers of a rim that is a sphere's: the light on it, and its ink foreshortened. Marks in
// brackets: README.md in this folder.
#pragma once

#include <cstddef>

namespace impactdic::circle {

struct SphereSettings {
  // fit_sphere_light.
  float margin_px = 1.5f;  // that samples keep from the picture's edge [definition]: bilinear
  double least_deg = 17;   // of a normal that is sampled, from the line of sight [hand]
  float beside_px = 1;     // samples are compared with their surroundings so far off [hand]
  float uneven_noise = 3.5f, uneven_least = 1;  // difference that ink makes: noises, plus grey
                                                // levels [hand]
  std::size_t cell_samples = 2;  // of a cell whose bright quantile is believed [hand]
  double bright = 0.97;          // of a cell's samples lie below its level of the paint [hand]
  int least_cells = 20;          // or there is no light [definition]: more than terms
  int envelope_passes = 12;      // of each start [hand]
  double start_deg[4] = {0, 25, 50, -15};  // elevations of the lamp to start from [hand]
  int settling_passes = 2;                 // of each window [hand]
  // Of the light of an earlier frame: directions from one whose samples tell how bright it is now
  // to the next, and how many times as many of them must be the paint's in another brightness
  // [hand].
  std::size_t brightness_every = 8;
  double brighter_crowd = 1.5;
  // Paint whose level is within this share of the light is bare. A light that so much of it has
  // told may be wrong by (paint_tells / share)² from side to side. The means tell it where they are
  // surely better and differ by more than so many deviations. [measured] spheres of 16 patterns, 60
  // px: e1, e2 show 0 to 0.12 bare, b3 0.2, f1, a2, a3 0.26 to 0.35, all others more.
  double bare = 0.06, much_bare = 0.4, paint_tells = 0.042, surely = 3, contradiction = 4;
  // Cells' means scatter by some of this, and no shading is held by so much more than by paint.
  double mean_sd = 0.3, mean_held = 20;  // [hand]
  int mean_passes = 8;                   // [hand]
  // Weights of no light of a kind, in cells; and what a cell is worth in samples.
  double least_light = 0.1;  // at a rim, of its brightest, that grey levels are told in [hand]
  int layers = 8;            // of samples where the light of a clip is learnt [hand]
  double held_lamp = 1e-3, held_limb = 0.01, held_soft = 0.3;  // [hand]
  double samples_of_cell = 8;                                  // [definition]: about
  double damping = 1e-6;                                       // settles what is undetermined
  double most_limb_step = 0.3;                                 // of one step [hand]
  double rim_z = 0.1;  // cosine of the normal where the rim's contrast is told [hand]
  // What shows background outside and ball inside.
  float least_contrast = 0.3f;  // of the usual contrast [hand]
  // The ink foreshortened, from strips of the surface that face the camera.
  double strip_px = 1;           // between the samples of a strip [hand]
  double most_strip = 0.75;      // sine of the normal at its end, at most [hand]
  int strips = 4;                // along each direction, begun at different places [hand]
  std::size_t strips_every = 2;  // lines from one with strips to the next [hand]
  double blur_reach = 3;         // of the edge's blur, deviations [definition]
  double retrace_steps = 0.06;   // as JudgementSettings::retrace_steps [hand]
  // How far crossings of the half level may lie from the rim of a sphere.
  // And how far off what they or the search found the rim may be sought by its model, px.
  double seek_px = 1.5;                                          // [hand]
  double crossings_centre_px = 0.1, crossings_radius_px = 0.35;  // [measured] light_accuracy
  // What light and foreshortened ink make of the radius that a disc's model finds is known to this
  // share of itself; in even light ink alone makes it. [measured] light_accuracy, eight patterns;
  // sphere of all sixteen, 30 to 115 px
  double of_correction = 0.35, of_even_correction = 0.25;
  // What light that is not the model's moves the centre by where most of the rim shows, share of
  // the radius; and how far it goes with the radius, of what an arc would make of that.
  double lit_centre_sd_of_r = 6e-5, bent_with_radius = 0.7;  // [measured] light_accuracy, 11 to 40
  // How much of what light and foreshortened ink may misplace the radius by goes into the centre of
  // an oval. [measured] spheres of 60 px, eight patterns, pressed by 9 % at 30 degrees
  double pressed_of_light = 0.45;
  // In even light, how much of what misplaces the radius misplaces single arcs. [measured] the
  // same, six patterns: centres 1.05 of their deviations
  double even_arcs = 0.5;
  // Light at the middle over that at the rim from which on a sphere is darker towards its limb
  // [hand].
  double darker_limb = 1.3;
  double most_of_usual = 1.5;  // and to so much of radius_sd_of_r [measured] the same
  double poor_misfit = 13;     // as LearningSettings::misfit: nothing is told by such a fit [hand]
  // Of the radius, beside what the model says, where no disc's model tells: how a texture learnt
  // from one frame misplaces it, or a disc's model that fits a sphere; this moves the centre, too.
  double radius_sd_of_r = 9e-4;       // [measured] light_accuracy, seven patterns
  double disc_centre_sd_of_r = 2e-4;  // [measured] the same
  // Farther apart than so many deviations the radii by rim and by turns say nothing of each other
  // [hand].
  double bias_sds = 4;
  // paint_beside_rim: deviations that are chance, as in a garrote (Breiman 1995) [hand]; share of
  // bare paint among the texture's samples from which on the light is right, and over which less
  // of it makes it wrong. [measured] spheres of the sixteen patterns, 30, 40 and 60 px: a2, a3, b3,
  // e1, e2, f2 show up to 0.2, of all others f1 and b2 alone as little.
  double paint_chance = 3, paint_seen = 0.25, paint_seen_over = 0.1;
  // learn_rim.
  double paint_sd = 0.03;    // of the level of bare paint about that of the light [hand]
  double outline_sd = 0.1;   // the same, of an outline [hand]
  double most_shift_px = 2;  // of the crossings, which ink, light and limb move inwards [hand]
  double grown_px[3] = {0, 0.8, 1.6};       // from which the rim is tried [hand]
  double hopeless = 2;                      // so far below a disc nothing can be gained [hand]
  double likelier_even = 0.3, even = 0.85;  // in light whose least is so much of its most [hand]
  // A sphere whose rim fades and that keeps less of its lines than this is known by an arc, which
  // may misplace it by so much, px.
  double most_left = 0.7;   // [hand]
  double arc_sd_px = 0.12;  // [measured] light_accuracy, seeds 1 to 3
  // The same of an outline, over the radius squared: its light is learnt of the ball's pixels.
  double outline_arc_px3 = 460;  // [measured] light_accuracy random 3001 3320
  // What light misplaces an outline by whose rim fades, over the radius, wherever it shows.
  // [measured] spheres of light_accuracy random 5001 5800
  double outline_centre_px2 = 3, outline_radius_px2 = 5;
  // Of the radius, what a disc's model or crossings misplace it by of which an arc shows: the lit
  // side of a ball. [measured] the same
  double lit_arc_of_r = 0.012;
  double likelier_known = -0.15;  // of a ball that is known to be a sphere [measured] the same
  double likelier = 0.02;         // of a line's ln p that a sphere must be above a disc [hand]
};
inline constexpr SphereSettings kSphere;

}  // namespace impactdic::circle
