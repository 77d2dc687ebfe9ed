#include <cstdio>

#include "host/app/command.h"
#include "host/app/video_options.h"

namespace impactdic::app {
namespace {

void line(const std::string& label, const std::string& value) {
  std::printf("%-16s %s\n", label.c_str(), value.c_str());
}

// Six digits: a header's figure without the noise of its conversion.
std::string rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

void run_info(const VideoRequest& request) {
  const auto source = open_requested(request, true);
  const VideoInfo& info = source->info();
  line("file", info.path);
  line("format", info.format + (info.storage.empty() ? "" : ", " + info.storage));
  if (!info.camera.empty()) line("camera", info.camera);
  line("size", std::to_string(info.width) + " x " + std::to_string(info.height) + " px, " +
                   std::to_string(info.bits) + " bit");
  line("frames", std::to_string(info.frame_count) + ", the first is number " +
                     std::to_string(info.first_frame_number));
  line("frame rate", info.fps ? rounded(*info.fps) + " 1/s" : "not in the file (give --fps)");
  if (info.record_step != 1) {
    line("stored", "every " + std::to_string(info.record_step) + "th recorded frame");
  }
  if (info.exposure_s) line("exposure", rounded(*info.exposure_s * 1e6) + " us");
  if (info.recorded_at) line("recorded", *info.recorded_at);
  if (info.has_timestamps && info.frame_count > 1) {
    if (const auto last = source->frame_time_s(info.frame_count - 1)) {
      line("timestamps", "a time for each frame, " + rounded(*last) + " s from first to last");
    }
  }
  for (const auto& [label, value] : info.extra) line(label, value);
  for (const std::string& warning : info.warnings) line("warning", warning);
}

}  // namespace

void add_info_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("info", "What a clip says of itself");
  auto request = std::make_shared<VideoRequest>();
  add_video_options(*command, *request);
  command->footer("Example:\n  impactdic info shot_01.cine\n");
  command->callback([request] { run_info(*request); });
}

}  // namespace impactdic::app
