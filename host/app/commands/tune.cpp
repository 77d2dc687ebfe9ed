// impactdic tune: the quickest variant of the correlation kernels on this device.
#include "host/benchmark/tune.h"

#include <cstdio>
#include <memory>

#include "host/app/command.h"
#include "host/app/run_context.h"

namespace impactdic::app {
namespace {

struct TuneArguments {
  Common common;
  benchmark::TuneOptions tune;
  int window_px = 0, search_px = 8;  // 0: the usual sizes
};

void run_tune(const TuneArguments& options) {
  RunContext context(options.common);
  opencl::Engine& engine = context.engine();
  std::printf("%s, driver %s\n", engine.device().name.c_str(), engine.device().driver.c_str());
  const benchmark::TuneSink sink = [](const benchmark::TunedVariant& tried) {
    std::printf("%-16s %-48s %11.4g windows/s  %.1e px  %s\n", tried.kernel.work.c_str(),
                tried.kernel.variant.c_str(), tried.kernel.per_second, tried.kernel.difference_px,
                tried.rejected.c_str());
    std::fflush(stdout);
  };
  const std::vector<dic::TunedKernel> best =
      benchmark::tune_and_keep(engine, options.window_px, options.search_px, options.tune, sink);
  for (const dic::TunedKernel& kernel : best) {
    std::printf("%s: %s\n", kernel.work.c_str(), kernel.variant.c_str());
  }
  std::printf("kept in %s\n", dic::tuning_file(engine).c_str());
}

}  // namespace

void add_tune_command(CLI::App& app) {
  auto options = std::make_shared<TuneArguments>();
  CLI::App* command = app.add_subcommand(
      "tune", "Find the quickest right variant of each kernel on this device, and keep it");
  add_common_options(*command, options->common);
  command->add_option("--window", options->window_px, "Only windows of this size (px)");
  command->add_option("--search", options->search_px, "Their search radius (px)")
      ->capture_default_str();
  command->add_option("--seconds", options->tune.seconds, "Time to measure each variant for")
      ->check(positive_number())
      ->capture_default_str();
  command->footer("Example:\n  impactdic tune --device gpu");
  command->callback([options] { run_tune(*options); });
}

}  // namespace impactdic::app
