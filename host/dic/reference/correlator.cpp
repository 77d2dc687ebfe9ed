#include "host/dic/correlator.h"

#include <optional>

#include "host/dic/discs.h"
#include "host/dic/frames/frame_slots.h"
#include "host/dic/neighbours.h"
#include "host/dic/reference/equal.h"
#include "host/dic/reference/icgn.h"
#include "host/dic/reference/published.h"
#include "host/dic/reference/zncc.h"
#include "host/dic/seed_options.h"

namespace impactdic::dic {
namespace {

class ReferenceCorrelator final : public Correlator {
 public:
  ReferenceCorrelator(const FieldOptions& options, int slots)
      : options_(options),
        slots_(slots),
        frames_(static_cast<std::size_t>(slots_.count())),
        discs_(slots) {
    options_.validate();
    if (options_.method == FieldMethod::kIcgn) icgn_.emplace(options_, slots);
    if (options_.method == FieldMethod::kPublished) published_.emplace(options_);
  }

  void set_frame(int slot, const Frame& frame) override {
    slots_.fill(slot, frame);
    frames_[static_cast<std::size_t>(slot)] = frame.to_float();
    if (icgn_) icgn_->set_frame(slot, frame);
    full_scale_ = frame.full_scale();
  }

  void set_disc(int slot, double cx_px, double cy_px, double radius_px) override {
    discs_.set(slot, cx_px, cy_px, radius_px);
    if (icgn_) icgn_->set_disc(slot, cx_px, cy_px, radius_px);
  }

  std::vector<WindowMotion> correlate(std::span<const Window> windows) override {
    slots_.check(windows);
    std::vector<WindowMotion> motions(windows.size());
    const auto search = [&](std::span<const Window> some, std::span<WindowMotion> found) {
      for (std::size_t i = 0; i < some.size(); ++i) found[i] = measure(some[i]);
    };
    if (!icgn_) {
      search(windows, motions);
      return motions;
    }
    WholeWindows whole;
    whole.search(windows, options_.window_px, discs_, WindowStatus::kLowCorrelation, motions,
                 search);
    const RefineWindows again = [&](std::span<const Window> lost,
                                    std::span<const WindowMotion> seeds,
                                    std::span<WindowMotion> found) {
      for (std::size_t i = 0; i < lost.size(); ++i) found[i] = icgn_->refine(lost[i], seeds[i]);
    };
    Neighbours neighbours;
    neighbours.refine_lost(windows, options_.window_px, again, motions);
    neighbours.judge_lost(windows, whole.cut(), again, motions);
    return motions;
  }

 private:
  WindowMotion measure(const Window& window) const {
    const auto first = frames_[static_cast<std::size_t>(window.first)].view();
    const auto second = frames_[static_cast<std::size_t>(window.second)].view();
    if (published_) return published_->measure(first, second, window, full_scale_);
    if (options_.method == FieldMethod::kEqual) {
      return equal_reference(first, second, window, options_, full_scale_);
    }
    const WindowMotion seed =
        zncc_reference(first, second, window, seed_options(options_), full_scale_);
    return icgn_ ? icgn_->refine(window, seed) : seed;
  }

  FieldOptions options_;
  FrameSlots slots_;
  std::vector<Image<float>> frames_;
  Discs discs_;
  std::optional<PublishedReference> published_;
  std::optional<IcgnReference> icgn_;
  double full_scale_ = 255;
};

}  // namespace

std::unique_ptr<Correlator> make_reference_correlator(const FieldOptions& options, int slots) {
  return std::make_unique<ReferenceCorrelator>(options, slots);
}

}  // namespace impactdic::dic
