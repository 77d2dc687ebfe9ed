// The main job on a body that is no sphere: its outline as an ellipse, and its turns.
#pragma once

#include "host/motion/round/round_body.h"
#include "host/pipeline/track_clip.h"

namespace impactdic::pipeline {

// A frame of the analysed ones, cut to the region of interest.
Frame read_cut(FrameSource& source, const FrameRange& frames, const Roi& roi, std::int64_t index);

// Frame after frame, one row each as track_clip gives them, without fields, poses and points to
// resume at. The outline is a row's circle; its motion is from one outline's centre to the next
// and the turn of the body, with what `body` says of its depth in the deviations. Errors of the
// reader come out after the rows before them.
void track_round(FrameSource& source, opencl::Engine& engine, const TrackOptions& options,
                 const motion::RoundBody& body, const TrackSink& sink, const ProgressFn& progress);

}  // namespace impactdic::pipeline
