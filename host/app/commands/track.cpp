#include <impactdic/track.h>

#include <cstdio>
#include <memory>

#include "host/app/command.h"
#include "host/app/run_context.h"
#include "host/app/setting_options.h"
#include "host/report/words.h"

namespace impactdic::app {
namespace {

struct Options {
  Common common;
  TrackRequest request;
  TrackFolder folder;
};

void run_track(Options& options) {
  Session session = open_session(options.common);
  options.folder.force = options.common.force;
  options.request.clip.open.lend_file_memory = true;  // main() answers for a file that is lost
  Terminal terminal(options.common.quiet);
  const TrackResult result =
      track_to_folder(options.request, options.folder, session, terminal.control());
  terminal.end();
  if (!options.common.quiet) {
    std::printf("%lld of %lld frames ok, %.1f frames/s; results in %s\n",
                static_cast<long long>(result.frames_ok),
                static_cast<long long>(result.frames.count()), result.frames_per_s,
                options.folder.folder.c_str());
    std::printf("%s\n", report::in_words(result.impact_si).c_str());
  }
  std::fputs(session.profile().c_str(), stderr);
}

}  // namespace

void add_track_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "track", "The main job: ball centre, velocity, rotation and field of every frame");
  auto options = std::make_shared<Options>();
  OptionAdder add(*command);
  run::visit_clip(add, options->request.clip);
  command->add_option("-o,--output", options->folder.folder, "Folder for the results")->required();
  run::visit_track_settings(add, options->request, options->folder);
  command->add_flag("--resume", options->folder.resume,
                    "Go on where an earlier run into the folder ended");
  add_common_options(*command, options->common);
  command->footer(
      "Writes track.csv, fields.h5, summary.json and job.toml.\nExample:\n"
      "  impactdic track shot_01.cine -o shot_01 --ball-diameter-mm 67 --surface-angle-deg 15\n");
  command->callback([options] { run_track(*options); });
}

}  // namespace impactdic::app
