// impactdic bench: speed of the kernels with their error beside it.
#include <cstdio>
#include <memory>

#include "host/app/command.h"
#include "host/app/run_context.h"
#include "host/benchmark/table.h"

namespace impactdic::app {
namespace {

struct BenchArguments {
  Common common;
  benchmark::BenchOptions bench;
  std::string json;
};

void run_bench(const BenchArguments& options) {
  RunContext context(options.common);
  benchmark::write_bench_table(context.engines(), options.bench, options.json,
                               [](const std::string& line) {
                                 std::printf("%s\n", line.c_str());
                                 std::fflush(stdout);
                               });
}

}  // namespace

void add_bench_command(CLI::App& app) {
  auto options = std::make_shared<BenchArguments>();
  CLI::App* command = app.add_subcommand(
      "bench", "Speed of the correlation on this device, with its error on a known shift");
  add_common_options(*command, options->common);
  command->add_option("--only", options->bench.only, "Only rows whose work contains this text");
  command->add_option("--seconds", options->bench.seconds, "Time to measure each row for")
      ->check(positive_number())
      ->capture_default_str();
  command->add_option("--batch", options->bench.batch, "Frame pairs a run (default: by device)")
      ->check(positive_number());
  command->add_flag("--all-variants", options->bench.every_variant,
                    "Every variant of a kernel, not only the one in use");
  command->add_option("--json", options->json, "Write the table to this file too");
  command->footer("Example:\n  impactdic bench --device gpu --json bench.json");
  command->callback([options] { run_bench(*options); });
}

}  // namespace impactdic::app
