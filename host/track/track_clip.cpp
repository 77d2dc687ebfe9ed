#include "host/track/track_clip.h"

#include <algorithm>
#include <cmath>

#include "host/base/error.h"
#include "host/dic/device_frames.h"
#include "host/track/frame_pipeline.h"
#include "host/track/scout_ball.h"

namespace impactdic {
namespace {

// One analysed frame while its row is being made. The slot is where the device holds it.
struct Pending {
  std::int64_t index = 0;  // among the analysed frames
  TrackRow row;
  Circle circle;  // in the cut-out's pixels
  Frame frame;
  int slot = 0;
};

class ClipTracker {
 public:
  ClipTracker(Engine* engine, const TrackOptions& options, const GridSink& grid_ready,
              const TrackSink& sink)
      : engine_(engine),
        options_(options),
        grid_ready_(grid_ready),
        sink_(sink),
        tracker_(options.ball) {}

  void take(FrameBatch& batch) {
    std::vector<Pending> frames;
    if (last_) frames.push_back(std::move(*last_));
    last_.reset();
    const std::size_t carried = frames.size();
    for (std::size_t i = 0; i < batch.frames.size(); ++i) {
      frames.push_back(
          locate(std::move(batch.frames[i]), batch.first_index + static_cast<std::int64_t>(i)));
    }
    if (options_.with_field) measure(frames, carried);
    for (std::size_t i = 0; i + 1 < frames.size(); ++i) finish(frames[i], i);
    last_ = std::move(frames.back());
  }

  // The last frame has no next one.
  void end() {
    if (!last_) return;
    if (last_->row.circle_ok) last_->row.status = TrackStatus::last_frame;
    emit(*last_, nullptr);
  }

 private:
  Pending locate(Frame frame, std::int64_t index) {
    Pending made;
    made.index = index;
    made.row.frame = options_.frames.at(index);
    const double rate =
        options_.fps > 0 ? options_.fps / static_cast<double>(options_.frames.step) : 1.0;
    made.row.time_s = static_cast<double>(index) / rate;
    const CircleFit fit = tracker_.track(frame, index);
    made.circle = fit.circle;
    set_circle(made.row, fit);
    made.frame = std::move(frame);
    made.slot = static_cast<int>(index % slots());
    return made;
  }

  int slots() const { return options_.batch + 1; }

  // Motions of all pairs among `frames` whose two balls were found. The first `carried` frames are
  // on the device already.
  void measure(std::vector<Pending>& frames, std::size_t carried) {
    pairs_.assign(frames.size(), PairMotion{});
    measured_.assign(frames.size(), false);
    std::vector<std::size_t> which;
    for (std::size_t i = 0; i + 1 < frames.size(); ++i) {
      if (frames[i].row.circle_ok && frames[i + 1].row.circle_ok) which.push_back(i);
    }
    if (which.empty()) {
      // Nothing to correlate; the last frame may still be the first of a later pair.
      if (estimator_) {
        frames_->set(frames.back().slot, frames.back().frame);
      } else if (frames.back().row.circle_ok) {
        open_estimator(frames);
      }
      return;
    }
    if (!estimator_) {
      open_estimator(frames);
    } else {
      for (std::size_t i = carried; i < frames.size(); ++i) {
        frames_->set(frames[i].slot, frames[i].frame);
      }
    }
    std::vector<PairMotion> batch;
    for (std::size_t i : which) {
      batch.push_back(pair_of(frames[i], frames[i + 1], last_rotation_rad_));
    }
    estimator_->measure(batch);
    retry_with_neighbours(batch);
    for (std::size_t k = 0; k < which.size(); ++k) {
      if (batch[k].motion.ok) last_rotation_rad_ = batch[k].motion.rot_rad;
      pairs_[which[k]] = std::move(batch[k]);
      measured_[which[k]] = true;
    }
  }

  static PairMotion pair_of(const Pending& a, const Pending& b, double guess_rot_rad) {
    PairMotion pair;
    pair.first_slot = a.slot;
    pair.second_slot = b.slot;
    pair.first = a.circle;
    pair.second = b.circle;
    pair.guess_rot_rad = guess_rot_rad;
    return pair;
  }

  // Within a batch all pairs start from the same guess of the spin. Where the spin has changed
  // since (an impact), the pairs that failed get their measured neighbour's.
  void retry_with_neighbours(std::vector<PairMotion>& batch) {
    for (std::size_t i = 1; i < batch.size(); ++i) {
      if (batch[i].motion.ok || !batch[i - 1].motion.ok) continue;
      if (std::abs(batch[i - 1].motion.rot_rad - batch[i].guess_rot_rad) < 1e-3) continue;
      batch[i].guess_rot_rad = batch[i - 1].motion.rot_rad;
      estimator_->measure({&batch[i], 1});
    }
  }

  void open_estimator(const std::vector<Pending>& frames) {
    std::vector<TrackRow> rows;
    for (const Pending& pending : frames) rows.push_back(pending.row);
    const double radius = options_.grid_radius_px.value_or(*median_radius_px(rows));
    frames_ = std::make_unique<DeviceFrames>(*engine_, slots());
    estimator_ = make_motion_estimator(*engine_, options_.estimator, radius, *frames_);
    for (const Pending& pending : frames) frames_->set(pending.slot, pending.frame);
    grid_ready_(estimator_->grid(), radius);
  }

  void finish(Pending& pending, std::size_t i) {
    const bool measured = options_.with_field && measured_[i];
    if (measured) {
      PairMotion& pair = pairs_[i];
      set_motion(pending.row, pair.motion);
      if (pending.row.status == TrackStatus::ok) pending.row.status = pair.status;
      if (pair.centre.ok) {
        pending.row.centre_u_px = pair.centre.u_px;
        pending.row.centre_v_px = pair.centre.v_px;
        pending.row.centre_u_sd_px = pair.centre.u_sd_px;
        pending.row.centre_v_sd_px = pair.centre.v_sd_px;
      }
      for (Window& window : pair.windows) {
        window.x0 += options_.roi.x;
        window.y0 += options_.roi.y;
      }
    } else if (options_.with_field && pending.row.circle_ok) {
      pending.row.status = TrackStatus::no_ball;  // in the next frame: nothing to move to
    }
    emit(pending, measured ? &pairs_[i] : nullptr);
  }

  void emit(Pending& pending, const PairMotion* pair) {
    if (pending.index < options_.start_index) return;
    pending.row.cx_px += options_.roi.x;
    pending.row.cy_px += options_.roi.y;
    sink_({pending.row, pending.frame, pair});
  }

  Engine* engine_;
  const TrackOptions& options_;
  const GridSink& grid_ready_;
  const TrackSink& sink_;
  BallTracker tracker_;
  std::unique_ptr<DeviceFrames> frames_;
  std::unique_ptr<MotionEstimator> estimator_;
  std::optional<Pending> last_;
  std::vector<PairMotion> pairs_;  // pair i: frames i, i + 1 of the batch
  std::vector<bool> measured_;
  double last_rotation_rad_ = 0;
};

}  // namespace

void track_clip(FrameSource& source, Engine* engine, const TrackOptions& options,
                const GridSink& grid_ready, const TrackSink& sink, const ProgressFn& progress) {
  constexpr std::int64_t kWarmUp = 16;
  options.estimator.validate();
  options.ball.validate();
  if (options.with_field && engine == nullptr) throw InvalidArgument("the field needs a device");
  TrackOptions scouted = options;
  scouted.ball.scouted_radius_px =
      scout_radius_px(source, options.frames, options.roi, options.ball.circle);
  ClipTracker tracker(engine, scouted, grid_ready, sink);
  const std::int64_t from = std::max<std::int64_t>(0, options.start_index - kWarmUp);
  try {
    for_each_batch(source, options.frames, from, options.roi, options.batch,
                   [&](FrameBatch& batch) {
                     const std::int64_t done =
                         batch.first_index + static_cast<std::int64_t>(batch.frames.size());
                     tracker.take(batch);
                     progress(done, options.frames.count());
                   });
  } catch (...) {
    tracker.end();  // what is measured stays measured
    throw;
  }
  tracker.end();
}

}  // namespace impactdic
