#include <impactdic/batch.h>
#include <impactdic/error.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "host/app/command.h"
#include "host/app/run_context.h"
#include "host/app/setting_options.h"
#include "host/cluster/launcher.h"

namespace impactdic::app {
namespace {

struct Options {
  Common common;
  BatchRequest request;
  std::string shard;  // "K/N"
};

// Processes that a launcher has started together share the shots, without being told.
void share_as_launched(Options& options) {
  BatchShare& share = options.request.share;
  const cluster::Launch launch =
      cluster::tell_launch([](const char* name) { return std::getenv(name); });
  if (!options.shard.empty()) {
    const std::size_t slash = std::min(options.shard.find('/'), options.shard.size());
    const std::string shards = options.shard.substr(std::min(slash + 1, options.shard.size()));
    CLI::Validator number = CLI::Range(1, 1000000);
    std::string k = options.shard.substr(0, slash), n = shards;
    if (!number(k).empty() || !number(n).empty()) {
      throw InvalidArgument("'" + options.shard + "' is no shard", "--shard", "K/N, such as 3/8");
    }
    share.shard = std::stoi(k);
    share.shards = std::stoi(n);
    if (share.name.empty()) share.name = launch.array.empty() ? "shards" : launch.array;
  }
  if (launch.size > 1) {
    share.member = "rank " + std::to_string(launch.rank) + " of " + launch.by;
    if (share.name.empty()) share.name = launch.name;
    if (share.name.empty() && !share.join) {
      throw InvalidArgument("the " + std::to_string(launch.size) + " processes of " + launch.by +
                                " have no name in common",
                            "--share", "give the run one: --share NAME");
    }
    std::string& device = options.common.session.device;
    if (options.request.track.with_field && (device == "auto" || device == "gpu")) {
      const int own = cluster::device_of_rank(launch, choose_device(device), list_devices());
      if (own != choose_device(device)) device = std::to_string(own);
    }
  }
}

void run_batch(Options& options) {
  share_as_launched(options);
  Session session = open_session(options.common);
  options.request.output.force = options.common.force;
  options.request.track.clip.open.lend_file_memory =
      true;  // main() answers for a file that is lost
  Terminal terminal(options.common.quiet);
  const BatchResult result = batch(options.request, session, terminal.control_with_results());
  terminal.end();
  if (options.common.quiet) return;
  const std::size_t good = result.shots.size() - result.failed - result.missing;
  if (result.joined) {
    std::printf("%zu of %zu shots measured; table in %s\n", good, result.shots.size(),
                result.table.c_str());
  } else {
    std::printf("%zu shots measured by this process, %zu failed\n", good, result.failed);
  }
}

}  // namespace

void add_batch_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("batch", "track for every clip of a folder, and one table");
  auto options = std::make_shared<Options>();
  BatchRequest& request = options->request;
  command->add_option("folder", request.folder, "Folder of clips, or of folders of pictures")
      ->required();
  command->add_option("-o,--output", request.output.folder, "Folder for the results")->required();
  command->add_option(
      "--table", request.table,
      "CSV with a row a shot: file, and any of surface_angle_deg, ball_diameter_mm, "
      "inertia_factor, drop_height_mm, ball, mass_g, notes");
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
