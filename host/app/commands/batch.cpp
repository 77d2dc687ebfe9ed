#include <impactdic/batch.h>

#include <algorithm>
#include <cstdio>
#include <memory>

#include "host/app/command.h"
#include "host/app/run_context.h"
#include "host/app/setting_options.h"
#include "host/report/shots_csv.h"
#include "host/run/batch/launched.h"
namespace impactdic::app {
namespace {

struct BatchArguments {
  Common common;
  BatchRequest request;
  std::string shard;  // "K/N"
};

void run_batch(BatchArguments& options) {
  run::share_as_launched(options.shard, options.request, options.common.session);
  Session session = open_session(options.common);
  options.request.output.force = options.common.force;
  options.request.track.clip.open.lend_file_memory =
      true;  // main() answers for a file that is lost
  Terminal terminal(options.common.quiet);
  const BatchResult result = batch(options.request, session, terminal.control_with_results());
  terminal.end();
  if (options.common.quiet) return;
  std::printf("%s\n", report::in_words(result).c_str());
}

}  // namespace

void add_batch_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("batch", "track for every clip of a folder, and one table");
  auto options = std::make_shared<BatchArguments>();
  BatchRequest& request = options->request;
  command->add_option("folder", request.folder, "Folder of clips, or of folders of pictures")
      ->required();
  command->add_option("-o,--output", request.output.folder, "Folder for the results")->required();
  command->add_option(
      "--table", request.table,
      "CSV with a row a shot: file, and any of surface_angle_deg, ball_diameter_mm, "
      "inertia_factor, drop_height_mm, camera, ball, mass_g, notes");
  command->add_flag("--resume", request.output.resume,
                    "Keep the shots that an earlier run measured; try the others");
  command
      ->add_option("--clips", request.clips,
                   "Clips measured at a time; 0: as many as threads, up to 4")
      ->check(CLI::Range(0, 64))
      ->capture_default_str();
  command->add_option("--share", request.share.name,
                      "Share the shots with all processes that give this name for the same folder; "
                      "under mpirun and srun they do so by themselves");
  command->add_option("--shard", options->shard,
                      "K/N: only the K-th of N parts of the shots; the last one joins all");
  command->add_flag("--join", request.share.join,
                    "Measure nothing: write the table of what several processes have measured");
  command
      ->add_option("--lost-after", request.share.lost_after_s,
                   "Seconds of silence after which a sharing process is given up")
      ->check(positive_number())
      ->capture_default_str();
  OptionAdder add(*command);
  run::visit_reading(add, request.track.clip);
  add_sandbox_option(*command);
  run::visit_track_settings(add, request.track, request.output);
  add_common_options(*command, options->common);
  command->footer(
      "Writes shots/NAME/ with what track writes of each clip, quarantine/NAME/reason.txt of "
      "those\n"
      "that failed, and shots.csv with a row for each; impactdic report makes one page of all.\n"
      "Example:\n"
      "  impactdic batch shots -o results --table shots.csv --fps 10000 --ball-diameter-mm 67\n"
      "  mpirun -n 4 --enable-recovery impactdic batch shots -o results --fps 10000\n");
  command->callback([options] { run_batch(*options); });
}

}  // namespace impactdic::app
