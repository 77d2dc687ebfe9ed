// The main job: ball, motion and field of every frame of a clip.
#pragma once

#include <functional>
#include <optional>
#include <span>

#include "host/base/progress.h"
#include "host/base/stage_times.h"
#include "host/circle/ball_tracker.h"
#include "host/clip/frame_range.h"
#include "host/clip/roi.h"
#include "host/motion/motion_estimator.h"
#include "host/pipeline/frame_pipeline.h"
#include "host/pipeline/resume_point.h"
#include "host/video/frame_source.h"

namespace impactdic::opencl {
class Engine;
}  // namespace impactdic::opencl

namespace impactdic::pipeline {

struct TrackOptions {
  motion::EstimatorOptions estimator;
  // Of a ball that is measured as a flat one though nothing tells whether it turns out of the
  // picture's plane: they state what doubt_motion says.
  bool tilt_is_unknown = false;
  circle::BallTrackerOptions ball;
  bool scouted = false;  // the ball was scouted for `ball`; otherwise that is done here
  FrameRange frames;
  Roi roi;                 // in whole-picture pixels, as every result
  bool with_field = true;  // false: circles only, no device needed
  double fps = 0;          // of the stored frames; 0 where unknown
  // Periods of the analysed frames since the first one, of each of them, where the camera lost some
  // in between; empty: none are missing.
  std::vector<std::int64_t> periods;
  int batch = 0;  // frames handed on at once; 0: as many as fill 16 MB
  // Batches whose frames are registered against keyframes ahead of their poses: see DeviceWorkers.
  int poses_ahead = 0;
  // Whether devices follow the circles of frames that lie where they are expected; without a value:
  // GPUs do in long clips.
  std::optional<bool> circles_on_device;
  StageTimes* times = nullptr;  // gets the stages' times where given
  // Goes on where an earlier run of the same options and batches was.
  std::optional<ResumePoint> from;
  // Asked once a batch of frames and, more often, while batches wait; true ends the run soon, as
  // if the clip ended there. Called from several threads at once.
  std::function<bool()> cancelled;
  // Frames as a camera takes them, in place of those of the source: gives the next batch, cut to
  // the region of interest and counted from 0 on, or nullptr at the end. It is measured and its
  // rows are given out before the next one is asked for. The ball's radius is then not looked for
  // first.
  std::function<std::shared_ptr<FrameBatch>()> feed;
  // Called between rows whenever such a point is reached: all rows before it are with the sink.
  std::function<void(const ResumePoint&)> checkpoint;
};

// One finished frame. Views are valid during the call only.
struct TrackedFrame {
  const TrackRow& row;
  const Frame& frame;              // cropped to the region of interest
  const motion::PairMotion* pair;  // field towards the next frame; nullptr where there is none
};

// Called once per analysed frame, in order.
using TrackSink = std::function<void(const TrackedFrame&)>;

// The windows' grid, once it is known: before the first row with a ball. `radius_px` is the ball's.
using GridSink = std::function<void(std::span<const Window> grid, double radius_px)>;

// Runs the whole clip on all `engines`; none are needed without field. Errors of the reader come
// out after every row that could still be measured has gone to `sink`. Neither the number of
// threads nor that of equal devices changes a result.
void track_clip(FrameSource& source, std::span<opencl::Engine* const> engines,
                const TrackOptions& options, const GridSink& grid_ready, const TrackSink& sink,
                const ProgressFn& progress);

}  // namespace impactdic::pipeline
