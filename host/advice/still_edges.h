// Edges that stand still before a ball that moves, or on it: those of a bar, a racket, a glint.
#pragma once

#include <impactdic/image.h>

#include <cstdint>
#include <memory>
#include <span>

#include "host/advice/clip_advice.h"
#include "host/advice/sphere_radius.h"
#include "host/dic/rigid_fit.h"

namespace impactdic::advice {

// The ball in a frame, and what it moves by to the next one.
struct MovedBall {
  std::int64_t index = 0;  // of the frame among the analysed ones
  Circle ball;
  dic::RigidMotion step;
};

struct StillEdges {
  // An image of the pictures: 0 on such edges and beside them, 255 elsewhere; nullptr where there
  // are none, or nothing tells.
  std::shared_ptr<const Image<std::uint8_t>> moving;
  // They leave too little of a ball to measure it by: no thing before it, but a pattern of the
  // sensor's own.
  bool cover_ball = false;
};

// About each ball some frames are read between which it, if it goes
// on as it does, moves its texture by some pixels. What stays as it was in them, though the ball
// would have carried the edge on, is no part of the ball: beside the ball's own edges it holds a
// registration back, by too little in a pair of frames to be told from noise. `noise`: deviation of
// a pixel, grey levels of the file.
StillEdges still_edges(std::span<const MovedBall> balls, double noise, const FarFrames& frames);

}  // namespace impactdic::advice
