#include <impactdic/advice.h>
#include <impactdic/units.h>

#include <cmath>
#include <cstdio>
#include <memory>

#include "host/app/command.h"
#include "host/app/setting_options.h"
#include "host/report/words.h"

namespace impactdic::app {
namespace {

void line(const std::string& label, const std::string& value) {
  std::printf("%-16s %s\n", label.c_str(), value.c_str());
}

template <typename... Values>
std::string say(const char* format, Values... values) {
  char text[240];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

// Six digits: a header's figure without the noise of its conversion.
std::string rounded(double value) { return say("%.6g", value); }

struct Options {
  InspectRequest request;
  double error_px = 0.01;
};

void print_clip(const Inspection& found) {
  const ClipInfo& info = found.clip;
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
  if (found.last_frame_time_s) {
    line("timestamps",
         "a time for each frame, " + rounded(*found.last_frame_time_s) + " s from first to last");
  }
  for (const auto& [label, value] : info.extra) line(label, value);
}

// `error_px`: the error that a person wants to reach.
void print_advice(const Inspection& found, double error_px) {
  const ClipAdvice& advice = found.advice;
  if (advice.ball) {
    line("ball", say("radius %.1f px%s, in %d of %d frames looked at", advice.ball->r_px,
                     found.camera ? say(" (%.2f mm)",
                                        advice.ball->r_px * 1e3 * found.camera->metre_per_px.value)
                                        .c_str()
                                  : "",
                     advice.frames_with_ball, advice.frames));
  }
  if (!advice.texture) return;
  const TextureAdvice& texture = *advice.texture;
  line("noise", say("%.2f grey levels of 255", texture.noise));
  line("texture", report::in_words(texture.asked));
  for (const SizeAdvice& size : texture.sizes) {
    if (size.window_px != texture.asked.window_px) line("", report::in_words(size));
  }
  const int enough = window_reaching(texture, error_px);
  line("window", enough > 0 ? say("%d px reach %g px a window", enough, error_px)
                            : say("no size reaches %g px a window", error_px));
  if (texture.ball && std::isfinite(texture.ball->dx_sd_px)) {
    line("whole ball",
         say("%.4f px and %.4f deg expected (--estimator ball)",
             std::hypot(texture.ball->dx_sd_px, texture.ball->dy_sd_px) / std::sqrt(2.0),
             texture.ball->rot_sd_rad * kDegPerRad));
  }
}

void run_info(Options& options) {
  options.request.clip.open.lend_file_memory = true;  // main() answers for a file that is lost
  const Inspection found = inspect(options.request);
  print_clip(found);
  if (found.camera) line("calibration", report::in_words(*found.camera));
  print_advice(found, options.error_px);
  for (const std::string& warning : found.warnings) line("warning", warning);
}

}  // namespace

void add_info_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "info", "What a clip says of itself, and what its texture lets be measured");
  auto options = std::make_shared<Options>();
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
  command->footer("Example:\n  impactdic info shot_01.cine\n");
  command->callback([options] { run_info(*options); });
}

}  // namespace impactdic::app
