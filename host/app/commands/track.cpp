#include <impactdic/error.h>
#include <impactdic/live/track_live.h>
#include <impactdic/track.h>

#include <cstdio>
#include <memory>

#include "host/app/clip_command.h"
#include "host/app/command.h"
#include "host/app/setting_options.h"
#include "host/report/live/live_json.h"
#include "host/report/words.h"

namespace impactdic::app {
namespace {

struct TrackArguments : ClipCommand<TrackRequest, TrackFolder> {
  bool live = false;
  LiveRequest as_live;
};

// What was written says so row by row; the exit status says it to scripts.
void require_a_ball(const TrackResult& result) {
  if (result.frames_with_ball > 0 || result.cancelled || result.frames_measured == 0) return;
  throw Error("no ball was found in any frame", result.clip.path,
              "impactdic info shows the clip; --radius-px says how large the ball is");
}

// Rows on stdout as they come; all else on stderr.
void run_live(TrackArguments& options) {
  LiveRequest& live = options.as_live;
  if (!options.folder.folder.empty()) {
    throw InvalidArgument("a live run writes rows to the standard output, no folder", "--output");
  }
  live.track = options.request;
  Session session = open_session(options.common);
  Terminal terminal(options.common.quiet);
  const LiveResult result = track_live(live, session, terminal.control(), [](const LiveRow& row) {
    const std::string line = report::live_json_line(row) + "\n";
    std::fwrite(line.data(), 1, line.size(), stdout);
    if (std::fflush(stdout) != 0) throw FileError("cannot write the rows", "standard output");
  });
  terminal.end();
  if (options.common.quiet) return;
  std::fprintf(stderr, "impactdic: %s\n", report::in_words(result).c_str());
}

void run_track(TrackArguments& options) {
  if (options.live) return run_live(options);
  if (options.folder.folder.empty()) throw CLI::RequiredError("--output");
  options.folder.keep_rows = false;
  if (options.request.clip.paths == std::vector<std::string>{"-"}) {
    throw InvalidArgument("a stream is measured as it comes", "-", "add --live");
  }
  const auto run = [](auto&&... given) { return track_to_folder(given...); };
  const TrackResult measured = run_clip_command(options, run, [&](const TrackResult& result) {
    std::printf("%lld of %lld frames ok, %.1f frames/s; results in %s\n",
                static_cast<long long>(result.frames_ok),
                static_cast<long long>(result.frames.count()), result.frames_per_s,
                options.folder.folder.c_str());
    std::printf("%s\n", report::in_words(result.impact_si).c_str());
  });
  require_a_ball(measured);
}

}  // namespace

void add_track_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "track", "The main job: ball centre, velocity, rotation and field of every frame");
  auto options = std::make_shared<TrackArguments>();
  OptionAdder add(*command);
  run::visit_clip(add, options->request.clip);
  add_sandbox_option(*command);
  command->add_option("-o,--output", options->folder.folder, "Folder for the results");
  run::visit_track_settings(add, options->request, options->folder);
  command->add_flag("--resume", options->folder.resume,
                    "Go on where an earlier run into the folder ended");
  command->add_flag("--live", options->live,
                    "Rows on the standard output while the frames come, a line of JSON each; "
                    "VIDEO is - or a pipe, --raw says what comes");
  const auto number = [&](const char* name, auto& value, const char* help) {
    command->add_option(name, value, help)->capture_default_str();
  };
  number("--look", options->as_live.look, "With --live: frames looked at before the first row");
  number("--wait", options->as_live.wait_s, "With --live: seconds that a batch takes to fill");
  number("--lag", options->as_live.lag_s,
         "With --live: seconds that frames wait before they are dropped; 0: none is");
  add_common_options(*command, options->common);
  command->footer(
      "Writes track.csv, fields.h5, summary.json and job.toml.\nExample:\n"
      "  impactdic track shot_01.cine -o shot_01 --ball-diameter-mm 67 --surface-angle-deg 15\n");
  command->callback([options] { run_track(*options); });
}

}  // namespace impactdic::app
