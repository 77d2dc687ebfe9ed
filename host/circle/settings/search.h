// Numbers of the search for a ball: in a whole picture, by what moves, by the scouts before a run,
// and of the first rim. Marks in brackets: README.md in this folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

namespace impactdic::circle {

// find_ball: the Hough transform on prepared pictures, candidates proved by their rim.
struct BallSearchSettings {
  int least_side_px = 16;       // of a picture in which a ball is looked for [hand]
  int hough_side_px = 320;      // the longer side of the picture that is transformed [hand]
  int most_shrink = 16;         // full pixels to one of that picture [hand]
  double least_hough_r_px = 5;  // least radius in that picture [hand]
  // Range of the radius where the user gives none: least in px, then shares of the shorter side.
  double least_r_px = 6, least_r_of_side = 0.03, most_r_of_side = 0.6;  // [hand]
  double blur_blob_px = 1.0;   // σ of the blur before the threshold (Otsu) [hand]
  double blur_hough_px = 1.2;  // σ of the blur before the transform [hand]
  int median_px = 5;           // side of the median filter of the last stage [hand]
  int disc_px[2] = {2, 5};     // radii of the discs that close and open blobs, tried in turn [hand]
  double canny = 80;           // upper threshold of OpenCV's Hough transform, grey levels [hand]
  double votes = 12;           // and its least number of votes for a centre [hand]
  double least_apart_px = 4;   // between two centres, in the reduced picture [hand]
  double apart_of_r = 0.5;     // and as a share of the least radius [hand]
  int candidates = 8;          // tried per prepared picture, at most [hand]
  double same_px = 1;          // two candidates that lie so near are one … [hand]
  double same_of_r = 0.015;    // … or so near as a share of the radius [hand]
  double least_candidate_r_px = 3;  // in full pixels; as CircleOptions::radius_range_px
  // Of the proof by measure_circle.
  int rays = 360;                    // half of the usual: a proof need not be exact [hand]
  double candidate_sd_of_r = 0.025;  // scatter of a Hough centre, share of the radius [hand]
  double least_candidate_sd_px = 2;  // and at least [hand]
  double proved = 0.5;               // share of the rim that leaves no doubt [hand]
  // A candidate so near a ball that is proved, in place and radius, is that ball: share of its
  // radius.
  double known_of_r = 0.15;  // [hand]
  // One whose circle touches that ball's rim, so nearly, its centre within so much of the ball's.
  double touches_of_r = 0.05, touching_of_r = 0.3;  // [hand]
  // By what moves.
  int moved_disc_px[2] = {1, 3};  // radii of the discs that close and open what moved [hand]
  double explained_of_r = 1.3;    // so far about a ball what moved belongs to it [hand]
  double other_of_r = 0.3;        // of its radius: another ball is not smaller [hand]
  // Two circles are one ball whose centres are so near, share of the larger radius.
  double overlap = 1.0;  // [hand]
};
inline constexpr BallSearchSettings kBallSearch;

// what_casts: a round shadow and the ball before it. Lengths without px are shares of the shadow's
// radius.
struct CastShadowSettings {
  int rays = 128;                  // along which it is looked at [hand]
  double begin = 0.97, end = 0.1;  // of a ray, from the rim inwards [hand]
  double outer = 1.3;              // where the surroundings are seen [hand]
  double darker = 0.9;             // a shadow is, than so much of what is about it [hand]
  double belt = 0.3,
         of_belt = 0.15;  // under the rim, and the least share of it that is flat [hand]
  double near = 0.15;  // flat is what lies so near the shadow's level, share of its contrast [hand]
  double soft = 0.25;  // width of the shadow's edge, at most [hand]
  double beyond = 1.1;       // of the radius of what lies before it: there it is seen [hand]
  double of_disc = 0.3;      // least share of it that has to be seen [hand]
  double marked = 0.05;      // share of it with another level than most of it has, at most, [hand]
  double covered = 0.4;      // or what an unknown thing may cover [hand]
  int levels = 2;            // of what is dark under the rim, tried: shadow, ink [hand]
  std::size_t least_px = 3;  // of a flat belt on a ray [hand]
  double least_arc = 0.15;   // share of the rays that show one [hand]
  double on_rim_px = 1.5;    // ends of the belt lie so near the rim of what casts it … [hand]
  double agree = 0.6;        // … so many of them [hand]
  double same_size = 0.3;    // radii differ by no more [hand]
  double least_off = 0.15;   // and centres by no less [hand]
  double found_sd[2] = {0.015, 0.04};  // scatter of the centre of what casts it, tried [hand]
  // A circle about both scatters by so much, and that of what casts the shadow by so much of it.
  double ragged_px = 1, of_ragged = 0.6;  // [hand]
  // What casts it shows so much of its rim, or less of one that is fair or clean [hand].
  double much_rim = 0.6, half_rim = 0.5, least_rim = 0.4;
  double fair_px = 0.4, clean_px = 0.15;
  double least_r_px = 20;  // of a shadow that pixels tell [hand]
  double rim = 0.1;  // what casts it shows no less of its rim than the shadow less so much, [hand]
  // or beside the shadow its rim is plain: so near it levels differ by so much of the shadow's
  // contrast [hand].
  std::pair<double, double> beside_px = {2, 4};
  double step = 0.1;
};
inline constexpr CastShadowSettings kCastShadow;

// StillScene: what stands still in some frames of a clip.
struct StillSettings {
  // Learnt from: with fewer nothing is known [hand], more would take long.
  std::size_t least_frames = 6, most_frames = 24;
  int longer_side_px = 640;    // of the reduced picture, at most [hand]
  double blur_px = 0.8;        // σ, in the reduced picture [hand]
  double other_light = 0.5;    // of the scatter left in one light, or it is not the light [hand]
  double some = 4000;          // pixels by which a picture is judged, at least [hand]
  double noises = 6;           // deviations of the noise that make a difference … [hand]
  double tremble_px = 0.5;     // … beside an edge that moves by so much, reduced px … [hand]
  double of_range = 0.02;      // … and so much of the picture's contrast [hand]
  double least_moved_px = 20;  // in one frame, reduced px, or nothing moves [hand]
  double most_moved = 0.5;     // of the picture in half of the frames: the camera moves [hand]
  double changed = 0.02;       // of a disc in which something else is to be seen [hand]
  double passing = 0.3;        // of the frames in which a still thing may be hidden [hand]
  // So much of all that moves lies in the disc, or so near: it is what moves [hand].
  double of_all_moved = 0.7, about_px = 2;
  double enough_rim = 0.4;  // or it may be an arc of something else [hand]
};
inline constexpr StillSettings kStill;

// scout_ball: the radius that several frames of a clip agree on.
struct ScoutSettings {
  std::int64_t first_frames = 12, most_frames = 48;  // doubled until they agree [hand]
  double same_radius = 0.05;  // radii that agree lie so near, share of the radius [hand]
  double well_seen = 0.3;     // share of the rim that a frame must show to count [hand]
  int agree = 3;              // frames that settle the question [hand]
  // A candidate is believed that so many frames show, or half of fewer; and so much of its rim, on
  // the mean, where it does not move by so much: px, share of the radius.
  double resting_rim = 0.4, moved_px = 1, moved_of_r = 0.02;  // [hand]
  // One that does not move gives way to one that moves by so much of its radius and shows so much
  // of as much rim.
  double plainly_moved_of_r = 0.1, as_plain = 0.5;  // [hand]
  // Another ball is seen beside the best in so many frames, shows so much of its rim and is not
  // smaller than so much of it.
  int at_once = 2;
  double other_rim = 0.5, other_of_r = 0.3;  // [hand]
  double found_sd_px = 1;                    // scatter of find_ball's circle [hand]
};
inline constexpr ScoutSettings kScout;

// search_rim: strong edges along rays, and the circle or ellipse that most rays agree on.
struct RimSearchSettings {
  int rays = 90;               // at least [hand]
  int of_usual_rays = 4;       // and one for so many of CircleOptions::rays [hand]
  int least_rays = 12;         // in the picture, or nothing is found [hand]
  int least_samples = 5;       // of a ray in the picture: a slope has two neighbours on either side
  float margin_px = 1.5f;      // that samples keep from the picture's edge [definition]: bilinear
  float in_view_px = 3;        // a rim so far inside the picture is in view [hand]
  double sds = 3;              // deviations of the prediction that the rays cover [hand]
  double beside_px = 4;        // and so far beyond, for a level on either side of an edge [hand]
  double rim_sd_of_r = 0.025;  // scatter of the rim's shape where nobody says more [hand]
  double least_sd_px = 0.05;   // of a prediction, however exact it claims to be [hand]
  double edge_sd_px = 0.3;     // scatter of a coarse edge, against the prior's figures [hand]
  double fixed_weight = 1e3;   // edge_sd_px over the scatter of a shape that must stay [definition]
  // Edges.
  double strong_rank = 0.8;      // the strength that a fifth of the rays exceed … [hand]
  double strong = 0.3;           // … and the share of it that makes an edge strong [hand]
  float least_strength = 1e-3f;  // grey levels: a flat picture has no edges [definition]
  // Agreement.
  double inlier_px = 1.0;  // a ray agrees whose edge lies so near [hand]
  double near_px = 2;      // edges farther off do not count as a ray's [hand]
  double tighten = 0.6;    // of the tolerance from one fit to the next (Chum et al., 2003) [hand]
  double trusted = 0.55;   // support at which the prediction needs no hypotheses [hand]
  int hypotheses = 240;    // at most [hand]
  std::size_t least_drawn_from = 15;  // rays: three in each of five sectors [hand]
  double seed_wide = 0.25;   // tolerance of a hypothesis' cost, share of the search's width [hand]
  double seed_refine = 0.5;  // and of the first fit to it [hand]
  double seed_slack = 1.02;  // a hypothesis may cost so much of the cheapest to be refined [hand]
  double seed_sds = 4;       // deviations from the prediction, at most [hand]
  double seed_prior = 1e-6;  // weight of the prior in a hypothesis: settles what is undetermined
  double seed_shape = 1e6;   // weight of the prior's shape in a circle's hypothesis [definition]
  // What is found.
  double least_r_px = 2;        // [hand]
  double least_support = 0.08;  // share of the rays in view [hand]
  double most_oval = 0.3;       // |e| / R [hand]
  double plain = 0.85;  // support of one polarity that leaves no doubt about the other [hand]
  double same_rim_of_r = 0.05;  // rims of both polarities that lie so near are one [hand]
  // The edge's width.
  int blur_half_px = 4;             // levels are read so far beside the edge [hand]
  int blur_near_px = 2;             // the steepest slope lies so near [hand]
  std::size_t blur_least_rays = 8;  // or the width is taken as 1 px [hand]
};
inline constexpr RimSearchSettings kRimSearch;

}  // namespace impactdic::circle
