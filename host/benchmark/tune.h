// Times every variant of the correlation kernels and finds the quickest right one.
#pragma once

#include <functional>
#include <vector>

#include "host/dic/device/tuning.h"

namespace impactdic::benchmark {

// A variant as it was tried.
struct TunedVariant {
  dic::TunedKernel kernel;
  std::string rejected;  // why it is not taken, empty where it may be
};

struct TuneOptions {
  // Difference from the double-precision reference above which a variant is rejected.
  double largest_difference_px = 1e-4;
  double seconds = 0.3;  // a variant
};

using TuneSink = std::function<void(const TunedVariant&)>;

// Tries each variant that the device allows, hands it to `sink`, and returns the quickest of the
// right ones. Throws Error where none is right.
dic::TunedKernel tune_zncc(opencl::Engine& engine, const FieldOptions& field,
                           const TuneOptions& options, const TuneSink& sink);
dic::TunedKernel tune_equal(opencl::Engine& engine, const FieldOptions& field,
                            const TuneOptions& options, const TuneSink& sink);

// Tries every kernel on windows of `window_px` with `search_px`, or, where `window_px` is 0, on the
// sizes that `correlate` and `track` use and `bench` measures; keeps the best for this device.
// Throws FileError at once where nothing can be kept, InvalidArgument for impossible sizes.
std::vector<dic::TunedKernel> tune_and_keep(opencl::Engine& engine, int window_px, int search_px,
                                            const TuneOptions& options, const TuneSink& sink);

}  // namespace impactdic::benchmark
