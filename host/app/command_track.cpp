#include <cstdio>
#include <memory>

#include "host/app/command.h"
#include "host/app/track_run.h"

namespace impactdic::app {
namespace {

void run_track(const CLI::App& command, const TrackRequest& request) {
  RunContext run(request.common, !request.no_field);
  const TrackOutcome outcome = track_to_folder(command, request, run);
  if (!request.common.quiet) {
    std::printf("%lld of %lld frames ok, %.1f frames/s; results in %s\n",
                static_cast<long long>(outcome.frames_ok), static_cast<long long>(outcome.frames),
                outcome.frames_per_s, request.output.c_str());
    std::printf("%s\n", outcome.impact.c_str());
  }
  run.print_profile();
}

}  // namespace

void add_track_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "track", "The main job: ball centre, velocity, rotation and field of every frame");
  auto request = std::make_shared<TrackRequest>();
  add_track_options(*command, *request);
  command->footer(
      "Writes track.csv, fields.h5, summary.json and job.toml.\nExample:\n"
      "  impactdic track shot_01.cine -o shot_01 --ball-diameter-mm 67 --surface-angle-deg 15\n");
  command->callback([command, request] { run_track(*command, *request); });
}

}  // namespace impactdic::app
