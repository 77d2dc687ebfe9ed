#include <optional>

#include "host/dic/correlator.h"
#include "host/dic/frame_slots.h"
#include "host/dic/icgn_reference.h"
#include "host/dic/published_reference.h"
#include "host/dic/seed_options.h"
#include "host/dic/zncc_reference.h"

namespace impactdic {
namespace {

class ReferenceCorrelator final : public Correlator {
 public:
  ReferenceCorrelator(const FieldOptions& options, int slots)
      : options_(options), slots_(slots), frames_(static_cast<std::size_t>(slots_.count())) {
    options_.validate();
    if (options_.method == FieldMethod::icgn) icgn_.emplace(options_, slots);
    if (options_.method == FieldMethod::published) published_.emplace(options_);
  }

  void set_frame(int slot, const Frame& frame) override {
    slots_.fill(slot, frame);
    frames_[static_cast<std::size_t>(slot)] = frame.to_float();
    if (icgn_) icgn_->set_frame(slot, frame);
    full_scale_ = frame.full_scale();
  }

  std::vector<WindowMotion> correlate(std::span<const Window> windows) override {
    slots_.check(windows);
    std::vector<WindowMotion> motions;
    motions.reserve(windows.size());
    for (const Window& window : windows) motions.push_back(measure(window));
    return motions;
  }

 private:
  WindowMotion measure(const Window& window) const {
    const auto first = frames_[static_cast<std::size_t>(window.first)].view();
    const auto second = frames_[static_cast<std::size_t>(window.second)].view();
    if (published_) return published_->measure(first, second, window, full_scale_);
    const WindowMotion seed =
        zncc_reference(first, second, window, seed_options(options_), full_scale_);
    return icgn_ ? icgn_->refine(window, seed) : seed;
  }

  FieldOptions options_;
  FrameSlots slots_;
  std::vector<Image<float>> frames_;
  std::optional<PublishedReference> published_;
  std::optional<IcgnReference> icgn_;
  double full_scale_ = 255;
};

}  // namespace

std::unique_ptr<Correlator> make_reference_correlator(const FieldOptions& options, int slots) {
  return std::make_unique<ReferenceCorrelator>(options, slots);
}

}  // namespace impactdic
