#include "host/dic/window_correlator.h"

#include "host/dic/seed_options.h"

namespace impactdic {

WindowCorrelator::WindowCorrelator(Engine& engine, const FieldOptions& options, int slots)
    : engine_(engine) {
  options.validate();
  if (options.method == FieldMethod::published) {
    published_.emplace(engine, options);
  } else {
    const FieldOptions seed = seed_options(options);
    zncc_.emplace(engine, seed, zncc_variants(engine.device(), seed).front());
  }
  if (options.method == FieldMethod::icgn) icgn_.emplace(engine, options, slots);
}

std::vector<WindowMotion> WindowCorrelator::correlate(DeviceFrames& frames,
                                                      std::span<const Window> windows) {
  for (const Window& window : windows) {
    if (frames.version(window.first) == 0 || frames.version(window.second) == 0) {
      throw InvalidArgument("a window names a frame slot which holds no frame");
    }
  }
  std::vector<WindowMotion> motions(windows.size());
  if (windows.empty()) return motions;
  windows_.reserve(engine_, windows.size());
  motions_.reserve(engine_, windows.size());
  windows_.write(engine_, windows);
  if (published_) published_->run(frames, windows_, windows.size(), motions_);
  if (zncc_) zncc_->run(frames, windows_, windows.size(), motions_);
  if (icgn_) icgn_->refine(frames, windows_, windows.size(), motions_);
  motions_.read(engine_, motions);
  return motions;
}

}  // namespace impactdic
