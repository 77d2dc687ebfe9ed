// Whether the pictures show a ball that turns out of their plane: a sphere, or what may be taken
// for a flat disc.
#pragma once

#include <span>
#include <string>

#include "host/advice/clip_advice.h"
#include "host/advice/sphere_radius.h"
#include "host/advice/still_edges.h"
#include "host/sphere/picture_blur.h"

namespace impactdic::advice {

struct BodyAdvice {
  Body body = Body::kDisc;
  std::string reason;       // one sentence
  bool is_measured = true;  // some pair was measured as a ball's
  // Were it a sphere, from its turns and its rim: the depth of a point follows from it, and with it
  // what a turn does to the picture.
  double radius_px = 0, radius_sd_px = 0;
  // The same by far turns alone, where two of them or more agree; NaN otherwise.
  Measured radius_by_turns_px;
  double blur_px2 = sphere::kUsualBlur_px2;  // of its pictures, see BallTask
  BallLight light{};                         // on it; all 0 where its turns do not show it
  // This over the camera's distance; NaN where that was known, or the pictures do not tell.
  Measured nearness;
  std::vector<MovedBall> moved;  // pairs whose motion was measured
  // Of a disc: the turn out of the picture's plane, rad a frame, that there may be without showing;
  // NaN where nothing tells.
  double unseen_tilt_rad = kNotMeasured;
};

// Of `known` below, field, perspective and what stands still before the ball are used.

// The pairs that are measured as flat balls'.
std::vector<MovedBall> discs_moved(opencl::Engine& engine, std::span<const BallPair> pairs,
                                   const motion::EstimatorOptions& known);

// A sphere where in one pair at least the turn out of the picture's plane is there beyond chance
// and the registration of a sphere fits the pictures better than that of a disc, or where such a
// turn adds up over many frames (slow_tilt). Else a disc: what it measures is then the same, and
// more exact in each pair. `far`: frames from which radius and distance can be had
// (sphere_from_turn). The perspective is that of the pairs' frames.
BodyAdvice judge_body(opencl::Engine& engine, std::span<const BallPair> pairs,
                      const motion::EstimatorOptions& known, const FarFrames& far);

}  // namespace impactdic::advice
