#include <cstdio>

#include "host/app/advice_output.h"
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

struct Request {
  VideoRequest video;
  dic::FieldOptions field;
  double error_px = 0.01;
};

// The ball's texture; that of the whole picture where there is no ball.
ClipAdvice look_at(FrameSource& source, const dic::FieldOptions& field) {
  advice::AdviceRequest request;
  request.frames = parse_frame_range("", source.info().frame_count);
  request.roi = {0, 0, source.info().width, source.info().height};
  request.field = field;
  ClipAdvice advice = advice::advise_clip(source, request);
  if (advice.ball) return advice;
  request.ball = false;
  return advice::advise_clip(source, request);
}

void run_info(const Request& request) {
  request.field.validate();
  const auto source = open_requested(request.video);
  const ClipInfo& info = source->info();
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
  const ClipAdvice advice = look_at(*source, request.field);
  for (const auto& [label, value] : advice_lines(advice, request.error_px)) line(label, value);
  for (const std::string& warning : all_warnings(request.video, info, advice)) {
    line("warning", warning);
  }
}

}  // namespace

void add_info_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "info", "What a clip says of itself, and what its texture lets be measured");
  auto request = std::make_shared<Request>();
  add_video_options(*command, request->video);
  command->add_option("--window", request->field.window_px, "Side of an interrogation window, px")
      ->capture_default_str();
  command
      ->add_option("--error-px", request->error_px, "An error to reach: says which window does, px")
      ->check(positive_number())
      ->capture_default_str();
  command->footer("Example:\n  impactdic info shot_01.cine\n");
  command->callback([request] { run_info(*request); });
}

}  // namespace impactdic::app
