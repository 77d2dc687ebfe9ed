#include "host/pipeline/correlate_clip.h"

#include <impactdic/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <future>
#include <utility>

#include "host/base/parallel/pipeline.h"
#include "host/dic/correlator.h"
#include "host/dic/device/ball.h"
#include "host/motion/coarse_search.h"
#include "host/motion/field_motion.h"
#include "host/opencl/engine.h"
#include "host/pipeline/frame_pipeline.h"

namespace impactdic::pipeline {
namespace {

constexpr int kFewestWindows = 3;
// Of the windows that have texture, the share that must agree on one motion. Below the first, the
// region is looked for anew wherever it may be; below the second, a few windows agreed by chance.
constexpr double kWellFound = 0.3, kFound = 0.1;
// Those few do not lie so far from what they agree on where it is the region's motion.
constexpr double kChancePx = 1;
// Another motion that so large a part of the windows agree on, over those of the best: parts that
// look alike, and nobody can tell which motion it was.
constexpr double kAsGood = 0.6;
// A clip that cannot be measured is not searched anew in every frame.
constexpr int kVainSearches = 3;

// One frame's result, owning its field.
struct Measured {
  CorrelatedFrame frame;
  std::vector<WindowMotion> field;
};

using FramePtr = std::shared_ptr<const Frame>;

// The region's pixels as the mask of a registration.
dic::BallOptions region_options(const CorrelateOptions& options, const ClipInfo& clip) {
  dic::BallOptions region;
  region.min_correlation = options.field.min_correlation;
  region.min_texture = options.field.min_texture;
  auto mask = std::make_shared<Image<std::uint8_t>>(clip.width, clip.height, 0);
  const Roi& roi = options.roi;
  for (int y = roi.y; y < roi.y + roi.height; ++y) {
    for (int x = roi.x; x < roi.x + roi.width; ++x) {
      (*mask)(x, y) = options.mask.size() == 0 || options.mask(x, y) != 0 ? 1 : 0;
    }
  }
  region.mask = std::move(mask);
  region.mask_is_body = true;
  return region;
}

// Frames on a device of its own queue, and what measures between them.
class Worker {
 public:
  Worker(const opencl::Engine& engine, const CorrelateOptions& options, const ClipInfo& clip)
      : engine_(engine.beside()),
        correlator_(dic::make_opencl_correlator(*engine_, options.field, kSlots)) {
    engine_->stop_when(options.cancelled);
    if (options.motion == RegionMotion::kRegion) {
      frames_.emplace(*engine_, kSlots);
      registration_.emplace(*engine_, region_options(options, clip));
    }
  }

  // Copies frame `index` there, unless it is there already. `slot` is its own.
  void hold(int slot, const Frame& frame, std::int64_t index) {
    std::int64_t& held = held_[static_cast<std::size_t>(slot)];
    if (held == index) return;
    correlator_->set_frame(slot, frame);
    if (frames_) frames_->set(slot, frame);
    held = index;
  }
  // The region as a whole; `task` holds what is expected.
  BallMotion register_region(const BallTask& task) {
    return registration_->measure(*frames_, {&task, 1})[0];
  }
  std::vector<WindowMotion> correlate(std::span<const Window> windows) {
    return correlator_->correlate(windows);
  }

 private:
  static constexpr int kSlots = 2;
  std::unique_ptr<opencl::Engine> engine_;
  std::unique_ptr<dic::Correlator> correlator_;
  std::optional<dic::DeviceFrames> frames_;
  std::optional<dic::BallRegistration> registration_;
  std::array<std::int64_t, kSlots> held_ = {-1, -1};
};

struct CorrelateStages {
  int read = 0, upload = 0, device = 0, fit = 0, write = 0;
};

// Where a frame is looked for depends on the one before: frames are measured one after the other,
// and while one is, the next one travels to the device.
class RegionCorrelator {
 public:
  RegionCorrelator(opencl::Engine& engine, const CorrelateOptions& options, const ClipInfo& clip,
                   const CorrelateStages& stages)
      : options_(options),
        stages_(stages),
        coarse_(engine, options.field),
        windows_(region_grid(options)),
        cx_px_(options.roi.x + (options.roi.width - 1) / 2.0),
        cy_px_(options.roi.y + (options.roi.height - 1) / 2.0) {
    const int workers = workers_of(engine, options);
    for (int k = 0; k < workers; ++k)
      workers_.push_back(std::make_unique<Worker>(engine, options, clip));
  }
  ~RegionCorrelator() {
    if (upload_.valid()) upload_.wait();
  }

  // Takes up an earlier run; `before` is the picture that its next motion starts from.
  void go_on(const CorrelatePoint& from, FramePtr before) {
    before_ = last_ = std::move(before);
    guess_.dx_px = from.dx_px;
    guess_.dy_px = from.dy_px;
    guess_.rot_rad = from.rot_rad;
    vain_searches_ = from.vain_searches;
  }

  // A CPU that is the device itself gains nothing from copies beside its kernels.
  static int workers_of(const opencl::Engine& engine, const CorrelateOptions& options) {
    return options.workers > 0 ? options.workers : engine.device().is_gpu ? 2 : 1;
  }

  // Sends the frame on its way and gives out the one before, measured; nullopt for the first, and
  // from where the run is cancelled on.
  std::optional<Measured> take(FramePtr frame, std::int64_t index) {
    return unless_stopped([&] { return next(std::move(frame), index); });
  }
  // The last one.
  std::optional<Measured> end() {
    return unless_stopped([&]() -> std::optional<Measured> {
      if (!next_) return std::nullopt;
      upload_.get();
      const Task now = *std::exchange(next_, std::nullopt);
      return measure(now);
    });
  }

 private:
  struct Task {
    FramePtr frame;
    std::int64_t index = 0;
  };

  template <typename Work>
  std::optional<Measured> unless_stopped(const Work& work) {
    stopped_ = stopped_ || (options_.cancelled && options_.cancelled());
    if (stopped_) return std::nullopt;
    try {
      return work();
    } catch (const opencl::Stopped&) {
      stopped_ = true;
      return std::nullopt;
    }
  }

  std::optional<Measured> next(FramePtr frame, std::int64_t index) {
    if (next_) upload_.get();
    std::optional<Task> now = std::exchange(next_, Task{std::move(frame), index});
    const bool ahead = workers_.size() > 1;
    if (!now) {
      if (!before_) before_ = next_->frame;
      upload_next(std::launch::async);
      return std::nullopt;
    }
    if (ahead) upload_next(std::launch::async);
    Measured out = measure(*now);
    if (!ahead) upload_next(std::launch::deferred);
    return out;
  }

  bool from_first() const { return options_.reference == ReferenceFrame::kFirst; }
  Worker& worker_of(std::int64_t index) {
    return *workers_[static_cast<std::size_t>(index) % workers_.size()];
  }
  int slot_of(std::int64_t index) const {
    return from_first() ? (index == 0 ? 0 : 1) : static_cast<int>(index % 2);
  }

  // Both pictures of the pair; the one before is mostly there.
  void upload_next(std::launch how) {
    const FramePtr before = from_first() || !last_ ? before_ : last_;
    const std::int64_t from = from_first() ? 0 : std::max<std::int64_t>(0, next_->index - 1);
    last_ = next_->frame;
    upload_ = std::async(how, [this, before, from, next = *next_] {
      const StageTimes::Scope timed(options_.times, stages_.upload);
      Worker& worker = worker_of(next.index);
      if (from < next.index) worker.hold(slot_of(from), *before, from);
      worker.hold(slot_of(next.index), *next.frame, next.index);
    });
  }

  Measured measure(const Task& now) {
    Measured out;
    CorrelatedFrame& frame = out.frame;
    frame.frame = options_.frames.at(now.index);
    const double rate =
        options_.fps > 0 ? options_.fps / static_cast<double>(options_.frames.step) : kNotMeasured;
    frame.time_s = static_cast<double>(now.index) / rate;
    if (now.index == 0) {
      frame.is_reference = true;
      frame.motion.ok = true;
    } else {
      out.field = look(now.index, frame);
      if (!frame.motion.ok || share_ < kWellFound) {
        search_anew(now, frame, out.field);
      } else {
        vain_searches_ = 0;
      }
      if (frame.motion.ok && options_.motion == RegionMotion::kRegion) {
        register_region(now.index, frame);
      }
      if (frame.motion.ok) guess_ = frame.motion;
    }
    if (now.index == 0 || !from_first()) before_ = now.frame;
    frame.after = {now.index + 1, guess_.dx_px, guess_.dy_px, guess_.rot_rad, vain_searches_};
    return out;
  }

  // Looks about what `guess_` says.
  std::vector<WindowMotion> look(std::int64_t index, CorrelatedFrame& out) {
    const int window_px = options_.field.window_px;
    const std::int64_t from = from_first() ? 0 : index - 1;
    motion::aim_windows(windows_, window_px, slot_of(from), slot_of(index),
                        {cx_px_, cy_px_, guess_.dx_px, guess_.dy_px, guess_.rot_rad});
    std::vector<WindowMotion> field;
    {
      const StageTimes::Scope timed(options_.times, stages_.device);
      field = worker_of(index).correlate(windows_);
    }
    const StageTimes::Scope timed(options_.times, stages_.fit);
    out.motion =
        dic::fit_rigid_motion(motion::field_points(windows_, field, window_px), cx_px_, cy_px_);
    motion::account_for_overlap(out.motion, window_px, options_.effective_spacing_px());
    share_ = motion::agreeing_share(out.motion, field);
    const double least = out.motion.residual_px > kChancePx ? kWellFound : kFound;
    if (out.motion.used < kFewestWindows || share_ < least) out.motion.ok = false;
    out.status = out.motion.ok ? TrackStatus::kOk : motion::explain_failure(field);
    return field;
  }

  // Replaces what the windows say of the motion by the registration of all pixels from there.
  void register_region(std::int64_t index, CorrelatedFrame& out) {
    const std::int64_t from = from_first() ? 0 : index - 1;
    const double reach = std::hypot(options_.roi.width, options_.roi.height) / 2;
    const dic::RigidMotion& guess = out.motion;
    BallMotion found;
    {
      const StageTimes::Scope timed(options_.times, stages_.device);
      found = worker_of(index).register_region(
          {slot_of(from), slot_of(index), static_cast<float>(cx_px_), static_cast<float>(cy_px_),
           static_cast<float>(reach), static_cast<float>(guess.dx_px),
           static_cast<float>(guess.dy_px), static_cast<float>(guess.rot_rad)});
    }
    if (found.status != static_cast<idic_int>(WindowStatus::kOk)) {
      out.motion.ok = false;
      out.status = TrackStatus::kLowCorrelation;
      return;
    }
    out.motion.dx_px = found.dx;
    out.motion.dy_px = found.dy;
    out.motion.rot_rad = found.rot_rad;
    out.motion.dx_sd_px = found.dx_sd;
    out.motion.dy_sd_px = found.dy_sd;
    out.motion.rot_sd_rad = found.rot_sd_rad;
  }

  // Finds the region without a guess and measures again; keeps what more windows agree on. Where
  // about as many agree on another motion, neither is known.
  void search_anew(const Task& now, CorrelatedFrame& out, std::vector<WindowMotion>& field) {
    if (vain_searches_ >= kVainSearches) return;
    ++vain_searches_;
    const dic::RigidMotion kept = guess_;
    double best = share_;
    std::vector<std::pair<dic::RigidMotion, double>> tried = {{out.motion, share_}};  // and share
    for (const dic::RigidMotion& coarse : coarse_.find(*before_, *now.frame, options_.roi)) {
      guess_ = coarse;
      CorrelatedFrame again = out;
      std::vector<WindowMotion> field_again = look(now.index, again);
      tried.emplace_back(again.motion, share_);
      if (share_ <= best) continue;
      best = share_;
      out = again;
      field = std::move(field_again);
      vain_searches_ = 0;
    }
    guess_ = kept;
    share_ = best;
    const double reach = std::min(options_.roi.width, options_.roi.height) / 2.0;
    const bool is_alike = std::any_of(tried.begin(), tried.end(), [&](const auto& other) {
      return other.first.ok && other.second >= kAsGood * best &&
             motion::are_apart(other.first, out.motion, reach);
    });
    if (!out.motion.ok || !is_alike) return;
    out.motion.ok = false;
    out.status = TrackStatus::kInconsistent;
  }

  const CorrelateOptions& options_;
  CorrelateStages stages_;
  std::vector<std::unique_ptr<Worker>> workers_;
  motion::CoarseSearch coarse_;
  std::vector<Window> windows_;
  double cx_px_, cy_px_;
  std::optional<Task> next_;  // on its way to the device
  std::future<void> upload_;
  FramePtr last_;           // the last one sent
  FramePtr before_;         // what the motion of the frame that is being measured starts from
  dic::RigidMotion guess_;  // the last motion measured: where to look next
  double share_ = 0;        // of the windows with texture that agreed on the last motion
  int vain_searches_ = 0;   // since a motion was found
  bool stopped_ = false;
};

// Has the correlator go on where an earlier run ended.
void take_up(RegionCorrelator& region, FrameSource& source, const CorrelateOptions& options) {
  const bool from_first = options.reference == ReferenceFrame::kFirst;
  auto before = std::make_shared<Frame>();
  source.read(options.frames.at(from_first ? 0 : options.from->next_row - 1), *before);
  region.go_on(*options.from, std::move(before));
}

}  // namespace

void correlate_clip(FrameSource& source, opencl::Engine& engine, const CorrelateOptions& options,
                    const CorrelateSink& sink, const ProgressFn& progress) {
  constexpr int kBatch = 8, kBatchesAhead = 8;
  options.field.validate();
  CorrelateStages stages;
  if (options.times != nullptr) {
    stages.read = options.times->add_stage("read", kBatchesAhead);
    stages.upload =
        options.times->add_stage("upload", RegionCorrelator::workers_of(engine, options));
    stages.device = options.times->add_stage("kernels, results", 1);
    stages.fit = options.times->add_stage("fits", 1);
    stages.write = options.times->add_stage("write", 1);
  }
  RegionCorrelator region(engine, options, source.info(), stages);
  const Roi whole{0, 0, source.info().width, source.info().height};
  const std::int64_t first = options.from ? options.from->next_row : 0;
  if (first > 0) take_up(region, source, options);
  BatchReader reader(source, options.frames, first, whole, kBatch);
  const auto is_cancelled = [&] { return options.cancelled && options.cancelled(); };
  std::exception_ptr error;
  std::int64_t done = first;
  const auto write = [&](Measured& measured) {
    const StageTimes::Scope timed(options.times, stages.write);
    measured.frame.field = measured.field;
    sink(measured.frame);
    progress(++done, options.frames.count());
  };
  using Read = std::shared_ptr<FrameBatch>;
  using Results = std::shared_ptr<std::vector<Measured>>;
  run_pipeline(
      kBatchesAhead, [&] { return is_cancelled() ? nullptr : reader.next(); },
      several_at_once([&](Read batch) {
        const StageTimes::Scope timed(options.times, stages.read);
        reader.decode(*batch);
        return batch;
      }),
      in_order([&](const Read& batch) {
        auto results = std::make_shared<std::vector<Measured>>();
        if (error) return results;
        error = batch->error;
        for (std::size_t i = 0; i < batch->frames.size(); ++i) {
          auto measured = region.take(FramePtr(batch, &batch->frames[i]),
                                      batch->first_index + static_cast<std::int64_t>(i));
          if (measured) results->push_back(std::move(*measured));
        }
        return results;
      }),
      in_order([&](const Results& results) {
        for (Measured& measured : *results) write(measured);
      }));
  if (auto last = region.end()) write(*last);
  if (error) std::rethrow_exception(error);
}

}  // namespace impactdic::pipeline
