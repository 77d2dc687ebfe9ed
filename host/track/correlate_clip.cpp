#include "host/track/correlate_clip.h"

#include <algorithm>
#include <utility>

#include "host/base/error.h"
#include "host/dic/correlator.h"
#include "host/track/coarse_search.h"
#include "host/track/field_motion.h"
#include "host/track/frame_pipeline.h"

namespace impactdic {
namespace {

constexpr int kFewestWindows = 3;
// Of the windows that have texture, the share that must agree on one motion. Below the first, the
// region is looked for anew wherever it may be; below the second, a few windows agreed by chance.
constexpr double kWellFound = 0.3, kFound = 0.1;
// A clip that cannot be measured is not searched anew in every frame.
constexpr int kVainSearches = 3;

bool on_surface(const Window& window, int window_px, const Image<std::uint8_t>& mask) {
  if (mask.size() == 0) return true;
  for (int y = window.y0; y < window.y0 + window_px; ++y) {
    for (int x = window.x0; x < window.x0 + window_px; ++x) {
      if (mask(x, y) == 0) return false;
    }
  }
  return true;
}

class RegionCorrelator {
 public:
  RegionCorrelator(Engine& engine, const CorrelateOptions& options, const CorrelateSink& sink)
      : options_(options),
        sink_(sink),
        correlator_(make_opencl_correlator(engine, options.field, 2)),
        coarse_(engine, options.field),
        windows_(region_grid(options)),
        cx_px_(options.roi.x + (options.roi.width - 1) / 2.0),
        cy_px_(options.roi.y + (options.roi.height - 1) / 2.0) {}

  void take(const Frame& frame, std::int64_t index) {
    CorrelatedFrame out;
    out.frame = options_.frames.at(index);
    const double rate =
        options_.fps > 0 ? options_.fps / static_cast<double>(options_.frames.step) : 1.0;
    out.time_s = static_cast<double>(index) / rate;
    std::vector<WindowMotion> field;
    if (index == 0) {
      correlator_->set_frame(0, frame);
      out.is_reference = true;
      out.motion.ok = true;
    } else {
      const bool first = options_.reference == ReferenceFrame::first;
      const int now = first ? 1 : static_cast<int>(index % 2);
      correlator_->set_frame(now, frame);
      field = measure(first ? 0 : 1 - now, now, out);
      if (!out.motion.ok || share_ < kWellFound) {
        search_anew(frame, first ? 0 : 1 - now, now, out, field);
      } else {
        vain_searches_ = 0;
      }
      if (out.motion.ok) guess_ = out.motion;
    }
    if (index == 0 || options_.reference == ReferenceFrame::previous) before_ = frame;
    out.field = field;
    sink_(out);
  }

 private:
  // Looks about what `guess_` says.
  std::vector<WindowMotion> measure(int before, int now, CorrelatedFrame& out) {
    const int window_px = options_.field.window_px;
    aim_windows(windows_, window_px, before, now,
                {cx_px_, cy_px_, guess_.dx_px, guess_.dy_px, guess_.rot_rad});
    std::vector<WindowMotion> field = correlator_->correlate(windows_);
    out.motion = fit_rigid_motion(field_points(windows_, field, window_px), cx_px_, cy_px_);
    account_for_overlap(out.motion, window_px, options_.effective_spacing_px());
    share_ = agreeing_share(out.motion, field);
    if (out.motion.used < kFewestWindows || share_ < kFound) out.motion.ok = false;
    out.status = out.motion.ok ? TrackStatus::ok : explain_failure(field);
    return field;
  }

  // Finds the region without a guess and measures again; keeps what more windows agree on.
  void search_anew(const Frame& frame, int before, int now, CorrelatedFrame& out,
                   std::vector<WindowMotion>& field) {
    if (vain_searches_ >= kVainSearches) return;
    ++vain_searches_;
    const RigidMotion coarse = coarse_.find(before_, frame, options_.roi);
    if (!coarse.ok) return;
    const RigidMotion kept = std::exchange(guess_, coarse);
    const double share = share_;
    CorrelatedFrame again = out;
    std::vector<WindowMotion> field_again = measure(before, now, again);
    if (share_ > share) {
      out = again;
      field = std::move(field_again);
      vain_searches_ = 0;
    }
    guess_ = kept;
  }

  const CorrelateOptions& options_;
  const CorrelateSink& sink_;
  std::unique_ptr<Correlator> correlator_;
  CoarseSearch coarse_;
  std::vector<Window> windows_;
  double cx_px_, cy_px_;
  Frame before_;           // what the motion is measured from
  RigidMotion guess_;      // the last motion measured: where to look next
  double share_ = 0;       // of the windows with texture that agreed on the last motion
  int vain_searches_ = 0;  // since a motion was found
};

}  // namespace

std::vector<Window> region_grid(const CorrelateOptions& options) {
  std::vector<Window> windows =
      rectangle_grid(options.roi.x, options.roi.y, options.roi.width, options.roi.height,
                     options.field.window_px, options.effective_spacing_px());
  std::erase_if(windows, [&](const Window& window) {
    return !on_surface(window, options.field.window_px, options.mask);
  });
  if (windows.empty()) {
    throw InvalidArgument("no interrogation window fits into the region", "--roi, --mask, --window",
                          "take a smaller window or a larger region");
  }
  return windows;
}

void correlate_clip(FrameSource& source, Engine& engine, const CorrelateOptions& options,
                    const CorrelateSink& sink, const ProgressFn& progress) {
  constexpr int kBatch = 8;
  options.field.validate();
  RegionCorrelator region(engine, options, sink);
  const Roi whole{0, 0, source.info().width, source.info().height};
  for_each_batch(source, options.frames, 0, whole, kBatch, [&](FrameBatch& batch) {
    for (std::size_t i = 0; i < batch.frames.size(); ++i) {
      const std::int64_t index = batch.first_index + static_cast<std::int64_t>(i);
      region.take(batch.frames[i], index);
      progress(index + 1, options.frames.count());
    }
  });
}

}  // namespace impactdic
