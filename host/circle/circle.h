// The ball in a frame as a circle: found by the Hough transform, measured by a sub-pixel fit.
#pragma once

#include <impactdic/circle.h>
#include <impactdic/image.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace impactdic::circle {

class Backdrop;
class BallChoice;
class RimModel;
class StillScene;

enum class CircleStatus {
  kOk,
  kNoBall,     // no circular edge was found
  kOutOfView,  // the centre lies outside the picture or too little of the rim is inside
};
const char* to_string(CircleStatus status);

// A measured circle with one standard deviation of each figure. Where the rim demands it an
// ellipse is fitted: semi-axes R ± |e| with |e|² = e1² + e2² and the long one at angle
// ½ atan2(e2, e1), which is r(φ) = R + e1 cos 2φ + e2 sin 2φ to first order in e/R (φ from x
// towards y, image axes, y down). R is then `circle.r_px`. Otherwise e1 = e2 = 0.
struct CircleFit {
  CircleStatus status = CircleStatus::kNoBall;
  Circle circle;
  double cx_sd_px = 0, cy_sd_px = 0, r_sd_px = 0;
  bool ellipse = false;
  double e1_px = 0, e2_px = 0;
  double e1_sd_px = 0, e2_sd_px = 0;
  // By how much the centre goes with the radius if what misplaces the rim bends it: not at all
  // where the whole rim shows, farther than the radius where half of it does.
  double cx_with_r = 0, cy_with_r = 0;
  // Of the radius' deviation what frames that share a rim model have alike.
  double shared_r_sd_px = 0;
  // The radius by this frame alone, whatever was known of it.
  double own_r_px = 0, own_r_sd_px = 0;
  ByHand by_hand = ByHand::kNo;
  bool bright = true;       // the ball is brighter than what lies behind it
  bool inked = false;       // ink reaches into most of the rim
  double residual_px = 0;   // scatter of the rim points that no ink disturbs
  int rim_points = 0;       // accepted
  double rim_fraction = 0;  // share of the full rim that carried the fit, 0 … 1
  // The edge's width and the ink beside it, as learnt from this frame or followed from an earlier
  // one. None where the picture does not follow such a model.
  std::shared_ptr<const RimModel> rim_model;
};

struct CircleOptions {
  // Search range of the radius; from the picture's size where absent.
  std::optional<std::pair<double, double>> radius_range_px;
  // Where the ball's centre may be: of the picture's size, 0 elsewhere. nullptr: anywhere.
  std::shared_ptr<const Image<std::uint8_t>> region;
  int rays = 720;
  bool allow_ellipse = true;
  // Known to be a sphere, or a disc: no other model of the rim is taken where its own holds, and of
  // a disc no deviation holds what a sphere would misplace. Absent: the rim tells.
  std::optional<bool> sphere;
  // The background's texture was taken away, as far as it is known and up to where a ball is
  // expected: what leaves the background may be the rest of it.
  bool evened = false;
  // Throws InvalidArgument.
  void validate() const;
};

// What earlier frames say of this one: where the ball should be and how large it is.
struct CirclePrior {
  Circle predicted;
  double centre_sd_px = 2.0;
  double e1_px = 0, e2_px = 0;  // predicted shape, as in CircleFit
  // How far the rim may lie from the predicted shape about its own centre; 2.5 % of the radius
  // where absent.
  std::optional<double> rim_sd_px;
  std::optional<bool> bright;                     // tried both ways where absent
  bool inked = false;                             // as in CircleFit: spares a trace
  std::shared_ptr<const RimModel> rim_model;      // as in CircleFit: spares the learning
  bool learn = true;                              // a rim model, where there is none
  bool unlearnt = false;                          // an earlier frame has shown none that holds
  double rim_fraction = 0;                        // as in CircleFit; 0: not known
  std::optional<double> radius_px, radius_sd_px;  // of the uncompressed ball
  double radius_bias_sd_px = 0;  // of an error that radius_px and this frame have in common
  std::optional<double> compression_axis_rad;  // image axes, y down
};

// A circle that has proved itself by its rim (measure_circle); good to about a pixel.
struct FoundBall {
  Circle circle;
  double rim_fraction = 0;  // as CircleFit
  double score = 0;         // length of rim that carried the fit: of two concentric ones the larger
  bool bright = true;       // as CircleFit
  double residual_px = 0;   // as CircleFit
};

// Finds balls anywhere in a frame (Hough transform on prepared pictures, dissertation,
// section 3.2.1), the best first. Every circle that the transform proposes must prove itself by its
// rim, so that speckles, a highlight inside the ball or a straight edge are not taken for a ball.
// With `scene`, what stands still is none, and what moved is looked at where the shape alone does
// not tell. The search ends with the first ball that leaves no doubt, if `all` is false; otherwise
// it goes on while more has moved than was found. `proofs`, where given, is told how many circles
// were tried by their rim, which is what takes the time. Safe on several threads.
std::vector<FoundBall> find_balls(const Frame& frame, const CircleOptions& options,
                                  const StillScene* scene, bool all, int* proofs = nullptr);

// The best of them; nullopt where there is none.
std::optional<Circle> find_ball(const Frame& frame, const CircleOptions& options,
                                const StillScene* scene = nullptr);

// The best of them that is not one of the balls which were not chosen; `index`: of the frame among
// those of the range. The same as find_ball without a choice.
std::optional<Circle> find_chosen_ball(const Frame& frame, std::int64_t index,
                                       const CircleOptions& options, const StillScene* scene,
                                       const BallChoice* choice);

// Whether the circle is one of those other balls; false without a choice.
bool is_another_ball(const BallChoice* choice, std::int64_t index, const Circle& circle);

// Whether a circle of the frame is a thing that never moves, as far as the scene tells: false
// without one.
bool stands_still(const StillScene* scene, const Frame& frame, const Circle& circle);

// Measures the ball near `prior` to a fraction of a pixel: sub-pixel edge along radial rays with a
// local edge level, robust circle (or ellipse) fit. Uses nothing but its arguments, so the frames
// of a clip may be measured on several threads at once. Throws InvalidArgument for a prior without
// a radius or options that contradict each other.
CircleFit measure_circle(const Frame& frame, const CirclePrior& prior,
                         const CircleOptions& options);

// The same before a background whose texture is known: measured in a frame in which that is evened
// about the ball, again until the ball stays where it was evened about. nullptr: an even
// background.
CircleFit measure_circle(const Frame& frame, const CirclePrior& prior, const CircleOptions& options,
                         const Backdrop* backdrop);

}  // namespace impactdic::circle
