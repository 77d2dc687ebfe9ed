#include "host/dic/correlator.h"

#include "host/dic/window_correlator.h"

namespace impactdic::dic {
namespace {

class OpenclCorrelator final : public Correlator {
 public:
  OpenclCorrelator(opencl::Engine& engine, const FieldOptions& options, int slots)
      : frames_(engine, slots), windows_(engine, options, slots) {}

  void set_frame(int slot, const Frame& frame) override { frames_.set(slot, frame); }

  void set_disc(int slot, double cx_px, double cy_px, double radius_px) override {
    windows_.set_disc(slot, cx_px, cy_px, radius_px);
  }

  std::vector<WindowMotion> correlate(std::span<const Window> windows) override {
    return windows_.correlate(frames_, windows);
  }

 private:
  DeviceFrames frames_;
  WindowCorrelator windows_;
};

}  // namespace

std::unique_ptr<Correlator> make_opencl_correlator(opencl::Engine& engine,
                                                   const FieldOptions& options, int slots) {
  return std::make_unique<OpenclCorrelator>(engine, options, slots);
}

}  // namespace impactdic::dic
