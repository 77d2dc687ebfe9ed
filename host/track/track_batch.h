// What the stages of `track_clip` hand on: some consecutive frames of the clip.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "host/track/ball_tracker.h"
#include "host/track/frame_pipeline.h"
#include "host/track/keyframes.h"
#include "host/track/motion_estimator.h"
#include "host/track/track_row.h"

namespace impactdic {

struct TrackBatch {
  std::int64_t first_index = 0;  // of frames[0] among the analysed frames
  // The last frame of the batch before, where there is one, and this batch's own.
  std::vector<const Frame*> frames;
  std::vector<TrackRow> rows;  // of `frames`; the last one is finished with the next batch
  std::vector<Circle> circles;
  // Pair i leads from frame i to frame i + 1; measured where both have a ball.
  std::vector<PairMotion> pairs;
  std::vector<bool> measured;
  // Who owns the frames.
  std::shared_ptr<FrameBatch> before, own;
  // The circles of the own frames, while they are being measured.
  std::vector<CircleFit> fits;
  BallTracker::Plan plan;
  // Behind the own frames.
  BallTracker::Memory tracker;
  std::optional<Keyframes::Memory> keyframes;  // with the ball estimator
};

}  // namespace impactdic
