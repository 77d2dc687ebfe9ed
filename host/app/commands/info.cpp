#include <impactdic/advice.h>

#include <cstdio>
#include <memory>

#include "host/app/command.h"
#include "host/app/setting_options.h"
#include "host/report/words/clip_words.h"
#include "host/run/results/inspection_files.h"

namespace impactdic::app {
namespace {

struct InfoArguments {
  InspectRequest request;
  double error_px = 0.01;
  std::string output;
  bool force = false;
};

void run_info(InfoArguments& options) {
  options.request.clip.open.lend_file_memory = true;  // main() answers for a file that is lost
  const Inspection found = inspect(options.request);
  std::fputs(report::in_words(found, options.error_px).c_str(), stdout);
  if (options.output.empty()) return;
  run::write_inspection(options.request, found, options.error_px, options.output, options.force);
}

}  // namespace

void add_info_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "info", "What a clip says of itself, and what its texture lets be measured");
  auto options = std::make_shared<InfoArguments>();
  OptionAdder add(*command);
  run::visit_clip(add, options->request.clip);
  add_sandbox_option(*command);
  command
      ->add_option("--window", options->request.field.window_px,
                   "Side of an interrogation window, px")
      ->capture_default_str();
  command
      ->add_option("--error-px", options->error_px, "An error to reach: says which window does, px")
      ->check(positive_number())
      ->capture_default_str();
  command->add_option("--camera", options->request.camera,
                      "Camera that `calibrate` wrote: its scale, distortion and tilt");
  command->add_flag("--candidates", options->request.candidates,
                    "What may be the ball over all of the clip, in the order of track --ball");
  command->add_option("-o,--output", options->output,
                      "Folder for the same as files, which impactdic report makes a page of");
  command->add_flag("--force", options->force, "Write into a folder that already holds files");
  command->footer("Example:\n  impactdic info shot_01.cine\n");
  command->callback([options] { run_info(*options); });
}

}  // namespace impactdic::app
