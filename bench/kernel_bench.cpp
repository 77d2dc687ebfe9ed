// `impactdic bench` without the rest of the program, for machines that have nothing but a driver.
//   kernel_bench [DEVICE [JSON [ONLY [all [log]]]]]     DEVICE as --device, or all; log: what the
//   compiler says, and the time of every kernel. ONLY "tune": what `impactdic tune` finds
#include <impactdic/error.h>

#include <cstdio>
#include <memory>

#include "host/base/log.h"
#include "host/benchmark/table.h"
#include "host/benchmark/tune.h"

namespace {

int tune(impactdic::opencl::Engine& engine) {
  const impactdic::benchmark::TuneSink sink = [](const impactdic::benchmark::TunedVariant& tried) {
    std::printf("%s, %s: %.4g windows/s, %.1e px %s\n", tried.kernel.work.c_str(),
                tried.kernel.variant.c_str(), tried.kernel.per_second, tried.kernel.difference_px,
                tried.rejected.c_str());
  };
  impactdic::FieldOptions field;
  field.method = impactdic::FieldMethod::kZncc;
  impactdic::benchmark::tune_zncc(engine, field, {}, sink);
  field.window_px = 31;
  field.search_px = 16;
  impactdic::benchmark::tune_zncc(engine, field, {}, sink);
  field.window_px = 32;
  field.min_correlation = 0.3;
  impactdic::benchmark::tune_equal(engine, field, {}, sink);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const auto argument = [&](int k) { return std::string(argc > k ? argv[k] : ""); };
  impactdic::benchmark::BenchOptions options;
  options.only = argument(3);
  options.every_variant = argument(4) == "all";
  if (argument(5) == "log") impactdic::set_log_verbosity(2);
  try {
    impactdic::opencl::EngineOptions settings;
    settings.profile = argument(5) == "log";
    std::vector<std::unique_ptr<impactdic::opencl::Engine>> own;
    if (argument(1) == "all") {
      for (const auto& device : impactdic::opencl::all_devices(impactdic::opencl::list_devices())) {
        own.push_back(
            std::make_unique<impactdic::opencl::Engine>(std::to_string(device.index), settings));
      }
    } else {
      own.push_back(
          std::make_unique<impactdic::opencl::Engine>(argc > 1 ? argv[1] : "auto", settings));
    }
    std::vector<impactdic::opencl::Engine*> engines;
    for (const auto& engine : own) engines.push_back(engine.get());
    if (options.only == "tune") return tune(*engines.front());
    impactdic::benchmark::write_bench_table(
        engines, options, argument(2), [](const std::string& line) { std::puts(line.c_str()); });
    if (settings.profile) std::printf("%s", engines.front()->profiler().table().c_str());
  } catch (const impactdic::Error& error) {
    std::fprintf(stderr, "kernel_bench: %s\n", error.line().c_str());
    return 1;
  }
}
