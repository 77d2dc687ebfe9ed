#include <optional>

#include "host/dic/correlator.h"
#include "host/dic/device_frames.h"
#include "host/dic/frame_slots.h"
#include "host/dic/icgn_opencl.h"
#include "host/dic/published_opencl.h"
#include "host/dic/seed_options.h"
#include "host/dic/zncc_opencl.h"
#include "host/opencl/buffer.h"

namespace impactdic {
namespace {

class OpenclCorrelator final : public Correlator {
 public:
  OpenclCorrelator(Engine& engine, const FieldOptions& options, int slots)
      : engine_(engine), slots_(slots), frames_(engine, slots) {
    if (options.method == FieldMethod::published) {
      published_.emplace(engine, options);
    } else {
      const FieldOptions seed = seed_options(options);
      zncc_.emplace(engine, seed, zncc_variants(engine.device(), seed).front());
    }
    if (options.method == FieldMethod::icgn) icgn_.emplace(engine, options, slots);
  }

  void set_frame(int slot, const Frame& frame) override {
    slots_.fill(slot, frame);
    frames_.set(slot, frame);
    if (icgn_) icgn_->frame_changed(slot);
  }

  std::vector<WindowMotion> correlate(std::span<const Window> windows) override {
    slots_.check(windows);
    std::vector<WindowMotion> motions(windows.size());
    if (windows.empty()) return motions;
    windows_.reserve(engine_, windows.size());
    motions_.reserve(engine_, windows.size());
    windows_.write(engine_, windows);
    if (published_) published_->run(frames_, windows_, windows.size(), motions_);
    if (zncc_) zncc_->run(frames_, windows_, windows.size(), motions_);
    if (icgn_) icgn_->refine(frames_, windows_, windows.size(), motions_);
    motions_.read(engine_, motions);
    return motions;
  }

 private:
  Engine& engine_;
  FrameSlots slots_;
  DeviceFrames frames_;
  // What the method takes; the others stay empty.
  std::optional<PublishedOpencl> published_;
  std::optional<ZnccOpencl> zncc_;
  std::optional<IcgnRefiner> icgn_;
  Buffer<Window> windows_;
  Buffer<WindowMotion> motions_;
};

}  // namespace

std::unique_ptr<Correlator> make_opencl_correlator(Engine& engine, const FieldOptions& options,
                                                   int slots) {
  options.validate();
  return std::make_unique<OpenclCorrelator>(engine, options, slots);
}

}  // namespace impactdic
