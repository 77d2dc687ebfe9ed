#include "host/pipeline/track_clip.h"

#include <impactdic/error.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <thread>

#include "host/base/parallel/parallel_for.h"
#include "host/base/parallel/pipeline.h"
#include "host/circle/scout_ball.h"
#include "host/circle/sphere/disc_doubt.h"
#include "host/opencl/engine.h"
#include "host/pipeline/device_workers.h"
#include "host/pipeline/rows/compare_rows.h"
#include "host/pipeline/rows/compare_with_path.h"
#include "host/pipeline/rows/doubt_motions.h"
#include "host/pipeline/rows/fill_row.h"
#include "host/pipeline/rows/repeated_frames.h"
#include "host/pipeline/rows/settle_centres.h"
#include "host/pipeline/run_size.h"
#include "host/pipeline/track_batch.h"
#include "host/pipeline/track_round.h"

namespace impactdic::pipeline {
namespace {

// Batches being read or waiting, beside those on the devices.
constexpr int kBatchesAhead = 8;

using Batch = std::shared_ptr<TrackBatch>;

// The stages behind the reader; but for `complete` each runs on one thread at a time, in the order
// of the frames.
class ClipTracker {
 public:
  ClipTracker(FrameSource& source, std::span<opencl::Engine* const> engines,
              const TrackOptions& options, int batch, const GridSink& grid_ready,
              const TrackSink& sink, const ProgressFn& progress)
      : source_(source),
        engines_(engines),
        options_(options),
        batch_(batch),
        grid_ready_(grid_ready),
        sink_(sink),
        progress_(progress),
        tracker_(options.ball),
        on_device_(options.with_field && DeviceWorkers::follow_circles(engines, options.ball.circle,
                                                                       options.frames.count(),
                                                                       options.circles_on_device)) {
    if (options.from) go_on(*options.from);
    if (options.times == nullptr) return;
    const int workers = options.with_field ? DeviceWorkers::count(engines) : 1;
    read_stage_ = options.times->add_stage("read", kBatchesAhead);
    lead_stage_ = options.times->add_stage("circle, ahead", 1);
    circle_stage_ = options.times->add_stage("circle, between", kBatchesAhead);
    if (options.with_field) {
      worker_stages_.upload = options.times->add_stage("upload", workers);
      worker_stages_.circles = options.times->add_stage("circles on device", workers);
      worker_stages_.device = options.times->add_stage("kernels, results", workers);
      worker_stages_.fit = options.times->add_stage("fits", workers);
      if (options.estimator.estimator == Estimator::kBall) {
        worker_stages_.ahead = options.times->add_stage("poses, ahead", workers);
        worker_stages_.poses = options.times->add_stage("poses (in order)", 1);
      }
    }
    write_stage_ = options.times->add_stage("write", 1);
  }

  int read_stage() const { return read_stage_; }
  bool is_cancelled() const { return options_.cancelled && options_.cancelled(); }

  // Follows the ball through the frames. nullptr behind a frame that could not be read.
  Batch locate(std::shared_ptr<FrameBatch> own) {
    if (error_ || is_cancelled()) return nullptr;
    error_ = own->error;
    if (own->frames.empty()) return nullptr;
    const StageTimes::Scope timed(options_.times, lead_stage_);
    auto batch = std::make_shared<TrackBatch>();
    batch->first_index = own->first_index - (last_frames_ ? 1 : 0);
    if (last_frames_) {
      add_frame(*batch, last_frames_->frames.back(), last_fit_, batch->first_index);
      batch->repeats.push_back(false);
      own->repeats.front() = is_same_picture(last_frames_->frames.back(), own->frames.front());
    }
    batch->repeats.insert(batch->repeats.end(), own->repeats.begin(), own->repeats.end());
    batch->fits.resize(own->frames.size());
    batch->plan = tracker_.lead(own->frames, own->first_index, batch->fits, own->repeats);
    // There are workers once an earlier batch has shown a ball.
    batch->circles_left = on_device_ && has_ball_ && tracker_.any_to_follow(batch->plan);
    has_ball_ = has_ball_ || std::any_of(batch->fits.begin(), batch->fits.end(), is_ball);
    batch->tracker = tracker_.memory();
    last_fit_ = stated(batch->fits.back(), batch->tracker);
    batch->before = std::move(last_frames_);
    batch->own = last_frames_ = std::move(own);
    return batch;
  }

  // Measures the circles that `locate` left; safe on several batches at once.
  Batch complete(Batch batch) const {
    if (!batch || is_cancelled()) return nullptr;
    const StageTimes::Scope timed(options_.times, circle_stage_);
    if (!batch->circles_left) complete_circles(*batch, {});
    return batch;
  }

  // Hands the batch to a device; returns one that is done, or nullptr.
  Batch measure(Batch batch) {
    if (!batch || dropped_ || is_cancelled()) {
      dropped_ = true;  // none of those behind it either: rows have no gaps
      return nullptr;
    }
    if (!options_.with_field) return batch;
    if (!workers_) open_workers(*batch);
    if (!workers_) return batch;  // no ball so far: no pairs
    return workers_->submit(batch);
  }

  // Gives out all rows of a batch but the last, which waits for its next frame.
  void write(Batch batch) {
    if (!batch) return;
    const StageTimes::Scope timed(options_.times, write_stage_);
    if (grid_is_new_.exchange(false)) {
      grid_ready_(workers_->grid(), workers_->radius_px());
      point_.grid_radius_px = workers_->radius_px();
    }
    const std::size_t rows = batch->frames.size() - 1;
    for (std::size_t i = 0; i < rows; ++i) fill_row(*batch, i);
    const bool leads_here = last_ && last_->rows.size() > 1;
    leave_out_repeats(*batch, leads_here ? &last_->rows[last_->rows.size() - 2] : nullptr,
                      last_ ? last_->repeats.back() : point_.repeated);
    compare_with_path(batch->rows);
    state_centres(*batch);
    for (std::size_t i = 0; i < rows; ++i) {
      motion::PairMotion* const pair = is_measured(*batch, i) ? &batch->pairs[i] : nullptr;
      // Not before: what a worker measured is slow to fetch, and is written next.
      if (pair != nullptr) into_picture(pair->windows);
      emit(*batch, i, pair);
    }
    const std::int64_t done = batch->first_index + static_cast<std::int64_t>(batch->frames.size());
    last_ = std::move(batch);
    note_point(*last_, done);
    progress_(done, options_.frames.count());
  }

  // Batch after batch, each to its end: rows wait for no frames but their own.
  void follow(const std::function<std::shared_ptr<FrameBatch>()>& feed) {
    while (auto read = feed()) {
      Batch batch = measure(complete(locate(std::move(read))));
      if (workers_) batch = workers_->take();
      write(std::move(batch));
    }
    end();
  }

  // What is still on the devices, then the clip's last frame, which has no next one, and then
  // the reader's error.
  void end() {
    while (workers_) {
      Batch batch = workers_->take();
      if (!batch) break;
      write(std::move(batch));
    }
    if (last_) {
      TrackRow& row = last_->rows.back();
      if (row.circle_ok) row.status = status_of_last(*last_);
      emit(*last_, last_->frames.size() - 1, nullptr);
    }
    if (error_) std::rethrow_exception(error_);
  }

 private:
  // Takes up an earlier run: the last frame before its next batch, and what it knew by then.
  void go_on(const ResumePoint& from) {
    point_ = from;
    tracker_.restore(from.tracker);
    last_fit_ = from.circle;
    has_ball_ = from.grid_radius_px.has_value();
    last_frames_ = std::make_shared<FrameBatch>();
    last_frames_->first_index = from.next_row;
    last_frames_->frames.push_back(read_cut(source_, options_.frames, options_.roi, from.next_row));
    note_repeats(*last_frames_);
  }

  // Behind a whole batch, so that the next one begins where it would have.
  void note_point(const TrackBatch& batch, std::int64_t done) {
    const FrameBatch& own = *batch.own;
    const bool whole = !own.error && static_cast<int>(own.frames.size()) == batch_;
    if (!options_.checkpoint || !whole || !batch.resumable || done >= options_.frames.count()) {
      return;
    }
    point_.next_row = done - 1;
    point_.circle =
        stated(batch.fits.back(), batch.tracker);  // once: its model of the rim is not kept
    point_.repeated = batch.repeats.back();
    point_.tracker = batch.tracker;
    if (batch.keyframes) point_.keyframes = batch.keyframes;
    options_.checkpoint(point_);
  }

  static bool is_ball(const circle::CircleFit& fit) {
    return fit.status == circle::CircleStatus::kOk;
  }

  void complete_circles(TrackBatch& batch,
                        std::span<const std::optional<circle::CircleFit>> followed) const {
    const FrameBatch& own = *batch.own;
    tracker_.complete(batch.plan, own.frames, batch.fits, followed);
    for (std::size_t i = 0; i < own.frames.size(); ++i) {
      add_frame(batch, own.frames[i], stated(batch.fits[i], batch.tracker),
                own.first_index + static_cast<std::int64_t>(i));
    }
    if (!source_.info().lossy) note_torn(batch);
  }

  // Of batches whose circles are left to the workers.
  CircleWork circle_work() const {
    CircleWork work;
    work.options = options_.ball.circle;
    work.expected = [this](const TrackBatch& batch) { return tracker_.expected(batch.plan); };
    work.complete = [this](TrackBatch& batch,
                           std::span<const std::optional<circle::CircleFit>> followed) {
      complete_circles(batch, followed);
    };
    return work;
  }

  // `fit` is as stated().
  void add_frame(TrackBatch& batch, const Frame& frame, const circle::CircleFit& fit,
                 std::int64_t index) const {
    batch.frames.push_back(&frame);
    batch.rows.push_back(row_of(fit, index));
    batch.circles.push_back(fit.circle);
    batch.shapes.push_back(motion::shape_of(fit));
  }

  // The circle as a row states it, by what the tracker knew behind its batch.
  circle::CircleFit stated(circle::CircleFit fit,
                           const circle::BallTracker::Memory& tracker) const {
    if (options_.estimator.sphere) circle::doubt_disc(fit);
    if (tracker.rim_bias) circle::take_off(*tracker.rim_bias, fit);
    return fit;
  }

  TrackRow row_of(const circle::CircleFit& fit, std::int64_t index) const {
    TrackRow row = row_without_ball(options_.frames, options_.fps, options_.periods, index);
    set_circle(row, fit);
    return row;
  }

  // The grid is that of the first ball seen.
  void open_workers(const TrackBatch& batch) {
    const auto seen = median_radius_px(batch.rows);
    if (!seen) return;
    // What comes from a camera is measured a batch at a time.
    const int ahead = options_.feed ? 1 : options_.poses_ahead;
    DeviceWorkers::Clip clip;
    clip.radius_px = point_.grid_radius_px.value_or(*seen);
    clip.width = options_.roi.width;
    clip.height = options_.roi.height;
    clip.batch = batch_;
    clip.batches = (options_.frames.count() - batch.first_index + batch_ - 1) / batch_;
    workers_ =
        std::make_unique<DeviceWorkers>(engines_, options_.estimator, clip, ahead, circle_work(),
                                        options_.cancelled, options_.times, worker_stages_);
    if (point_.keyframes) {
      workers_->restore(*point_.keyframes, [&](std::int64_t index) {
        return read_cut(source_, options_.frames, options_.roi, index);
      });
    }
    grid_is_new_ = true;
  }

  TrackStatus status_of_last(const TrackBatch& batch) const {
    const std::size_t rows = batch.rows.size();
    const bool alone = !options_.with_field || rows < 2;
    return alone ? TrackStatus::kLastFrame : status_behind(batch.rows[rows - 2]);
  }

  static bool is_measured(const TrackBatch& batch, std::size_t i) {
    return i < batch.measured.size() && batch.measured[i];
  }

  void into_picture(std::span<Window> windows) const {
    for (Window& window : windows) {
      window.x0 += options_.roi.x;
      window.y0 += options_.roi.y;
    }
  }

  bool is_doubted() const { return options_.tilt_is_unknown && !options_.estimator.sphere; }
  const BallLight& light() const { return options_.estimator.sphere_light; }

  // By what circles and motions say of each other, and with them what motions state.
  void state_centres(TrackBatch& batch) {
    state_motions(batch, doubt_motions(batch.rows, batch.pairs));
    // A motion that states no more than circles do tells nothing of them.
    std::vector<bool> changed =
        settle_centres(batch.rows, batch.pairs, !is_doubted(), point_.centre);
    const auto rows = std::span(batch.rows).first(batch.rows.size() - 1);  // the last comes again
    compare_with_poses(rows, point_.centre, changed);
    state_motions(batch, changed);
  }

  void state_motions(TrackBatch& batch, const std::vector<bool>& changed) const {
    for (std::size_t i = 0; i + 1 < changed.size(); ++i) {
      if (!changed[i] || !is_measured(batch, i)) continue;
      state_motion(batch.rows[i], batch.rows[i + 1], batch.pairs[i], light(), is_doubted());
    }
  }

  void fill_row(TrackBatch& batch, std::size_t i) const {
    TrackRow& row = batch.rows[i];
    if (!is_measured(batch, i)) {
      // No ball in the next frame: nothing to move to.
      if (options_.with_field && row.circle_ok) row.status = TrackStatus::kNoBall;
      return;
    }
    set_pair(row, batch.rows[i + 1], batch.pairs[i], light(), is_doubted());
  }

  void emit(TrackBatch& batch, std::size_t i, const motion::PairMotion* pair) {
    TrackRow& row = batch.rows[i];
    if (source_.info().sizes_differ) forget_way(row);
    place_in_clip(row, options_.roi, options_.frames);
    sink_({row, *batch.frames[i], pair});
  }

  FrameSource& source_;
  std::span<opencl::Engine* const> engines_;
  const TrackOptions& options_;
  int batch_;
  const GridSink& grid_ready_;
  const TrackSink& sink_;
  const ProgressFn& progress_;
  int read_stage_ = 0, lead_stage_ = 0, circle_stage_ = 0, write_stage_ = 0;
  WorkerStages worker_stages_;
  // Of `locate`.
  circle::BallTracker tracker_;
  bool on_device_;         // circles may be left to the workers
  bool has_ball_ = false;  // a batch has shown one
  std::shared_ptr<FrameBatch> last_frames_;
  circle::CircleFit last_fit_;  // as stated()
  std::exception_ptr error_;
  // Of `measure`.
  bool dropped_ = false;
  std::unique_ptr<DeviceWorkers> workers_;
  // Of `write`.
  std::atomic<bool> grid_is_new_ = false;
  ResumePoint point_;
  Batch last_;
};

}  // namespace

void track_clip(FrameSource& source, std::span<opencl::Engine* const> engines,
                const TrackOptions& options, const GridSink& grid_ready, const TrackSink& sink,
                const ProgressFn& progress) {
  options.estimator.validate();
  options.ball.validate();
  if (options.with_field && engines.empty()) throw InvalidArgument("the field needs a device");
  if (options.from && options.from->next_row + 1 >= options.frames.count()) {
    throw InvalidArgument("an earlier run has gone beyond the end of this clip", "--resume",
                          "give the clip and the frames of that run");
  }
  const int size = frames_in_batch(options, source.info().bits);
  const std::int64_t first = options.from ? options.from->next_row + 1 : 0;
  BatchReader reader(source, options.frames, first, options.roi, size);
  if (options.feed) {
    ClipTracker tracker(source, engines, options, size, grid_ready, sink, progress);
    return tracker.follow(options.feed);
  }
  TrackOptions scouted = options;
  if (!options.scouted) {
    const circle::Scouted found =
        circle::scout_ball(source, options.frames, options.roi, options.ball.circle);
    scouted.ball.scouted_radius_px = found.radius_px();
    scouted.ball.scene = found.scene;
    scouted.ball.backdrop = found.backdrop;
  }
  ClipTracker tracker(source, engines, scouted, size, grid_ready, sink, progress);
  using Read = std::shared_ptr<FrameBatch>;
  on_threads(threads_beside(options, engines), [&] {
    run_pipeline(
        kBatchesAhead, [&] { return tracker.is_cancelled() ? nullptr : reader.next(); },
        several_at_once([&](Read batch) {
          const StageTimes::Scope timed(options.times, tracker.read_stage());
          reader.decode(*batch);
          return batch;
        }),
        in_order([&](Read batch) { return tracker.locate(std::move(batch)); }),
        several_at_once([&](Batch batch) { return tracker.complete(std::move(batch)); }),
        in_order([&](Batch batch) { return tracker.measure(std::move(batch)); }),
        in_order([&](Batch batch) { tracker.write(std::move(batch)); }));
  });
  tracker.end();
}

}  // namespace impactdic::pipeline
