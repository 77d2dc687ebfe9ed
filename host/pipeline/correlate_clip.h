// Full-field displacement of any speckled surface in a clip, and the robust rigid motion of the
// region about its centre.
#pragma once

#include <impactdic/correlate.h>

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "host/base/progress.h"
#include "host/base/stage_times.h"
#include "host/clip/frame_range.h"
#include "host/clip/roi.h"
#include "host/clip/track_row.h"
#include "host/dic/field.h"
#include "host/dic/rigid_fit.h"
#include "host/pipeline/resume_point.h"
#include "host/video/frame_source.h"

namespace impactdic::opencl {
class Engine;
}  // namespace impactdic::opencl

namespace impactdic::pipeline {

struct CorrelateOptions {
  FieldOptions field;
  int spacing_px = 0;  // 0: half a window, rounded up
  FrameRange frames;
  Roi roi;  // where windows stand; the motion is that of its centre
  ReferenceFrame reference = ReferenceFrame::kFirst;
  RegionMotion motion = RegionMotion::kWindows;
  Image<std::uint8_t> mask;     // empty, or the picture's size: only pixels that are not 0 count
  double fps = 0;               // of the stored frames; 0 where unknown (time_s then counts frames)
  int workers = 0;              // pictures on the device at a time, 1 or 2; 0: as suits the device
  StageTimes* times = nullptr;  // gets the stages' times where given
  // As TrackOptions::cancelled.
  std::function<bool()> cancelled;
  std::optional<CorrelatePoint> from;  // of the run that this one takes up
  int effective_spacing_px() const {
    return spacing_px > 0 ? spacing_px : (field.window_px + 1) / 2;
  }
};

// The windows that the options ask for, in whole-picture pixels. Throws InvalidArgument where none
// fits.
std::vector<Window> region_grid(const CorrelateOptions& options);

// Motion from the reference to this frame. Frame 0 is the reference itself: zero by definition.
struct CorrelatedFrame {
  std::int64_t frame = 0;
  double time_s = 0;
  bool is_reference = false;
  TrackStatus status = TrackStatus::kOk;
  dic::RigidMotion motion;              // of the region's centre
  std::span<const WindowMotion> field;  // per window of region_grid; empty for the reference
  CorrelatePoint after;                 // where a run goes on that ends behind this frame
};

using CorrelateSink = std::function<void(const CorrelatedFrame&)>;

// Called in order, once a frame. Reading and writing run beside the measurement.
void correlate_clip(FrameSource& source, opencl::Engine& engine, const CorrelateOptions& options,
                    const CorrelateSink& sink, const ProgressFn& progress);

}  // namespace impactdic::pipeline
