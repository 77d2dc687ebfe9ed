// `impactdic bench` without the rest of the program, for machines that have nothing but a driver.
//   kernel_bench [DEVICE [JSON [ONLY [all [log]]]]]     log: what the compiler says,
//   and the time of every kernel
#include <cstdio>

#include "bench/table.h"
#include "host/base/error.h"
#include "host/base/log.h"

int main(int argc, char** argv) {
  const auto argument = [&](int k) { return std::string(argc > k ? argv[k] : ""); };
  impactdic::BenchOptions options;
  options.only = argument(3);
  options.every_variant = argument(4) == "all";
  if (argument(5) == "log") spdlog::set_level(spdlog::level::debug);
  try {
    impactdic::EngineOptions settings;
    settings.profile = argument(5) == "log";
    impactdic::Engine engine(argc > 1 ? argv[1] : "auto", settings);
    impactdic::print_bench_table(engine, options, argument(2));
    if (settings.profile) std::printf("%s", engine.profiler().table().c_str());
  } catch (const impactdic::Error& error) {
    std::fprintf(stderr, "kernel_bench: %s\n", error.line().c_str());
    return 1;
  }
}
