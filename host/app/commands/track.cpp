#include <impactdic/error.h>
#include <impactdic/track.h>

#include <algorithm>
#include <cstdio>
#include <memory>

#include "host/app/clip_command.h"
#include "host/app/command.h"
#include "host/app/setting_options.h"
#include "host/report/words.h"

namespace impactdic::app {
namespace {

using Options = ClipCommand<TrackRequest, TrackFolder>;

// What was written says so row by row; the exit status says it to scripts.
void require_a_ball(const TrackResult& result) {
  const bool seen = std::any_of(result.rows.begin(), result.rows.end(),
                                [](const TrackRow& row) { return row.circle_ok; });
  if (seen || result.cancelled || result.rows.empty()) return;
  throw Error("no ball was found in any frame", result.clip.path,
              "impactdic info shows the clip; --radius-px says how large the ball is");
}

void run_track(Options& options) {
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
