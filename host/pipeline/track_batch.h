// What the stages of `track_clip` hand on: some consecutive frames of the clip.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "host/circle/ball_tracker.h"
#include "host/clip/track_row.h"
#include "host/motion/motion_estimator.h"
#include "host/motion/pose/keyframes.h"
#include "host/pipeline/frame_pipeline.h"

namespace impactdic::pipeline {

struct TrackBatch {
  std::int64_t first_index = 0;  // of frames[0] among the analysed frames
  // The last frame of the batch before, where there is one, and this batch's own.
  std::vector<const Frame*> frames;
  // Whether a frame is the picture of the one before it; when written, whether it is left out.
  std::vector<bool> repeats;
  std::vector<TrackRow> rows;  // of `frames`; the last one is finished with the next batch
  std::vector<Circle> circles;
  std::vector<motion::BallShape> shapes;
  // Pair i leads from frame i to frame i + 1; measured where both have a ball.
  std::vector<motion::PairMotion> pairs;
  std::vector<bool> measured;
  // Who owns the frames.
  std::shared_ptr<FrameBatch> before, own;
  // The circles of the own frames, while they are being measured.
  std::vector<circle::CircleFit> fits;
  circle::BallTracker::Plan plan;
  // Whether a device worker completes them: until then `frames` and `rows` hold none of them.
  bool circles_left = false;
  // Behind the own frames.
  circle::BallTracker::Memory tracker;
  std::optional<motion::Keyframes::Memory> keyframes;  // with the ball estimator
  // Whether a run that goes on there makes the poses that this one makes: no frame behind it is
  // registered ahead of what is known there.
  bool resumable = true;
};

// The circles that `lead` has left, where a device may follow them first.
struct CircleWork {
  circle::CircleOptions options;
  // What is expected of those of a batch, and their frames among its own.
  std::function<std::vector<circle::CirclePrior>(const TrackBatch&)> expected;
  // Completes the batch with what a device has followed of them: one for each, or none at all.
  std::function<void(TrackBatch&, std::span<const std::optional<circle::CircleFit>>)> complete;
};

}  // namespace impactdic::pipeline
