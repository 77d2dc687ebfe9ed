#include <impactdic/correlate.h>

#include <cstdio>
#include <memory>

#include "host/app/clip_command.h"
#include "host/app/command.h"
#include "host/app/setting_options.h"
#include "host/report/words.h"

namespace impactdic::app {
namespace {

using CorrelateArguments = ClipCommand<CorrelateRequest, CorrelateFolder>;

void run_correlate(CorrelateArguments& options) {
  run_clip_command(options, correlate_to_folder, [&](const CorrelateResult& result) {
    std::printf("%lld of %lld frames measured with %zu windows, %.1f frames/s; results in %s\n",
                static_cast<long long>(result.frames_measured),
                static_cast<long long>(result.frames.count() - 1), result.windows,
                result.frames_per_s, options.folder.folder.c_str());
    if (!result.noise_floor) return;
    std::printf("noise floor: %s\n", report::in_words(*result.noise_floor).c_str());
  });
}

}  // namespace

void add_correlate_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "correlate", "Full-field displacement of any speckled surface, from frame to frame");
  auto options = std::make_shared<CorrelateArguments>();
  OptionAdder add(*command);
  run::visit_correlate(add, options->request, options->folder);
  add_sandbox_option(*command);
  command->add_option("-o,--output", options->folder.folder, "Folder for the results")->required();
  command->add_flag("--resume", options->folder.resume,
                    "Go on where an earlier run into the folder ended");
  command->get_option("--roi")->description(
      "X,Y,W,H: the rectangle that is measured, px; without it, the picture less the search "
      "radius");
  add_common_options(*command, options->common);
  command->footer(
      "Writes motion.csv (rigid motion of the region about its centre), fields.h5, summary.json "
      "and job.toml.\nExample:\n  impactdic correlate plate.tif --roi 100,80,200,200 -o results\n");
  command->callback([options] { run_correlate(*options); });
}

}  // namespace impactdic::app
