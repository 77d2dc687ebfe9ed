#include "host/pipeline/track_round.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>
#include <utility>

#include "host/motion/round/round_turn.h"
#include "host/pipeline/rows/fill_row.h"

namespace impactdic::pipeline {
namespace {

// One frame, and its body where it shows one.
struct Shown {
  Frame frame;
  TrackRow row;
  double centre_sd_px = 0;
  motion::RoundView view;
};

class RoundTracker {
 public:
  RoundTracker(opencl::Engine& engine, const TrackOptions& options, const motion::RoundBody& body,
               bool positions_hold)
      : options_(options),
        body_(body),
        positions_hold_(positions_hold),
        turn_(engine, body.round()) {}

  Shown look(Frame frame, std::int64_t index) const {
    Shown shown;
    shown.row = row_without_ball(options_.frames, options_.fps, options_.periods, index);
    if (const auto outline = circle::find_silhouette(frame)) {
      set_circle(shown.row, circle::as_fit(*outline));
      shown.centre_sd_px = outline->centre_sd_px;
      shown.view = motion::round_view(frame, *outline, body_.round());
    }
    shown.frame = std::move(frame);
    return shown;
  }

  // Of the frame `index`, to the next one.
  void measure(Shown& shown, const Shown& next, std::int64_t index) {
    if (!shown.row.circle_ok) return;
    if (!next.row.circle_ok) {
      shown.row.status = TrackStatus::kNoBall;
      return;
    }
    const motion::RoundTurn::Doubt doubt{std::max(shown.centre_sd_px, next.centre_sd_px),
                                         body_.depth_sd()};
    dic::RigidMotion motion =
        turn_.measure(shown.view, next.view, body_.light_beside(index, index + 1), doubt);
    // Of views that have much of their texture in common the mean is texture, too.
    if (!motion.ok) motion = turn_.measure(shown.view, next.view, {}, doubt);
    if (!motion.ok) {
      shown.row.status = TrackStatus::kLowCorrelation;
      return;
    }
    motion.dx_px = next.row.cx_px - shown.row.cx_px;
    motion.dy_px = next.row.cy_px - shown.row.cy_px;
    motion.dx_sd_px = motion.dy_sd_px = std::hypot(shown.centre_sd_px, next.centre_sd_px);
    set_round_motion(shown.row, motion);
    if (!positions_hold_) forget_way(shown.row);
  }

  void emit(Shown& shown, const TrackSink& sink) const {
    shown.row.cx_px += options_.roi.x;
    shown.row.cy_px += options_.roi.y;
    sink({shown.row, shown.frame, nullptr});
  }

 private:
  const TrackOptions& options_;
  const motion::RoundBody& body_;
  bool positions_hold_;  // from one picture to the next
  motion::RoundTurn turn_;
};

}  // namespace

Frame read_cut(FrameSource& source, const FrameRange& frames, const Roi& roi, std::int64_t index) {
  Frame whole, frame;
  source.read(frames.at(index), whole);
  crop(whole, roi, frame);
  return frame;
}

void track_round(FrameSource& source, opencl::Engine& engine, const TrackOptions& options,
                 const motion::RoundBody& body, const TrackSink& sink, const ProgressFn& progress) {
  RoundTracker tracker(engine, options, body, !source.info().sizes_differ);
  const std::int64_t count = options.frames.count();
  std::optional<Shown> before;
  std::exception_ptr error;
  for (std::int64_t index = 0; index < count && !error; ++index) {
    if (options.cancelled && options.cancelled()) break;
    try {
      Shown shown = tracker.look(read_cut(source, options.frames, options.roi, index), index);
      if (before) {
        tracker.measure(*before, shown, index - 1);
        tracker.emit(*before, sink);
      }
      before = std::move(shown);
      progress(index + 1, count);
    } catch (const Error&) {
      error = std::current_exception();
    }
  }
  if (before) {
    if (before->row.circle_ok) before->row.status = TrackStatus::kLastFrame;
    tracker.emit(*before, sink);
  }
  if (error) std::rethrow_exception(error);
}

}  // namespace impactdic::pipeline
