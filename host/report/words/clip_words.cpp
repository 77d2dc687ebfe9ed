#include "host/report/words/clip_words.h"

#include <impactdic/units.h>

#include <cmath>

#include "host/base/parse.h"
#include "host/report/words.h"
#include "host/report/words/text.h"

namespace impactdic::report {
namespace {

std::string line(const std::string& label, const std::string& value) {
  return say("%-16s %s\n", label.c_str(), value.c_str());
}

// Six digits: a header's figure without the noise of its conversion.
std::string rounded(double value) { return say("%.6g", value); }

std::string clip_lines(const Inspection& found) {
  const ClipInfo& info = found.clip;
  std::string text = line("file", info.path);
  text += line("format", info.format + (info.storage.empty() ? "" : ", " + info.storage));
  if (!info.camera.empty()) text += line("camera", info.camera);
  text += line("size", std::to_string(info.width) + " x " + std::to_string(info.height) + " px, " +
                           std::to_string(info.bits) + " bit");
  text += line("frames", std::to_string(info.frame_count) + ", the first is number " +
                             std::to_string(info.first_frame_number));
  text +=
      line("frame rate", info.fps ? rounded(*info.fps) + " 1/s" : "not in the file (give --fps)");
  if (info.record_step != 1) {
    text += line("stored", "every " + std::to_string(info.record_step) + "th recorded frame");
  }
  if (info.exposure_s) text += line("exposure", rounded(*info.exposure_s * 1e6) + " us");
  if (info.recorded_at) text += line("recorded", *info.recorded_at);
  if (found.last_frame_time_s) {
    text += line("timestamps", "a time for each frame, " + rounded(*found.last_frame_time_s) +
                                   " s from first to last");
  }
  for (const auto& [label, value] : info.extra) text += line(label, value);
  return text;
}

std::string texture_lines(const TextureAdvice& texture, double error_px) {
  std::string text = line("noise", say("%.2f grey levels of 255", texture.noise));
  text += line("texture", in_words(texture.asked));
  for (const SizeAdvice& size : texture.sizes) {
    if (size.window_px != texture.asked.window_px) text += line("", in_words(size));
  }
  const int enough = window_reaching(texture, error_px);
  text += line("window", enough > 0 ? say("%d px reach %g px a window", enough, error_px)
                                    : say("no size reaches %g px a window", error_px));
  if (texture.ball && std::isfinite(texture.ball->dx_sd_px)) {
    text += line("whole ball",
                 say("%.4f px and %.4f deg expected (--estimator ball)",
                     std::hypot(texture.ball->dx_sd_px, texture.ball->dy_sd_px) / std::sqrt(2.0),
                     texture.ball->rot_sd_rad * kDegPerRad));
  }
  return text;
}

std::string ball_line(const Inspection& found, const ClipAdvice& advice) {
  std::string radius = say("radius %.1f px", advice.ball->r_px);
  if (found.camera) {
    radius += say(" (%.2f mm)", advice.ball->r_px * 1e3 * found.camera->metre_per_px.value);
  }
  return line("ball", radius + say(", in %d of %d frames looked at", advice.frames_with_ball,
                                   advice.frames));
}

std::string in_words(const BallSeen& seen, int frames) {
  return say(
      "radius %.1f px, %.0f %% of its rim seen, moves by %.0f px; in %d of %d frames looked "
      "at, as at %.0f, %.0f in frame %lld",
      seen.radius_px, 100 * seen.rim_fraction, seen.moved_px, seen.frames, frames, seen.place.cx_px,
      seen.place.cy_px, static_cast<long long>(seen.frame));
}

std::string candidate_lines(const Inspection& found) {
  if (!found.candidate_frames) return {};
  if (found.candidates.empty()) return line("candidates", "nothing that may be a ball is seen");
  std::string text;
  for (std::size_t i = 0; i < found.candidates.size(); ++i) {
    text += line("candidate " + std::to_string(i + 1),
                 in_words(found.candidates[i], found.candidate_frames));
  }
  return text;
}

}  // namespace

std::string in_words(const Inspection& found, double error_px) {
  std::string text = clip_lines(found);
  if (found.camera) text += line("calibration", in_words(*found.camera));
  if (found.advice.ball) text += ball_line(found, found.advice);
  if (found.advice.texture) text += texture_lines(*found.advice.texture, error_px);
  text += candidate_lines(found);
  for (const std::string& warning : found.warnings) text += line("warning", warning);
  return text;
}

std::string in_words(const CalibrateResult& found) {
  std::string text = "scale " +
                     plus_minus(found.metre_per_px.value * 1e3, found.metre_per_px.sd * 1e3) +
                     " mm/px in the plane of motion\n";
  text += say("distortion: %s, at most %.2f px; points scatter by %.3f px\n", found.terms.c_str(),
              found.distortion_px, found.point_sd_px);
  if (found.camera.focal_length_known) {
    text += "the camera is tilted by " + plus_minus(found.tilt_deg.value, found.tilt_deg.sd) +
            " deg against the plane\n";
  }
  for (const std::string& verdict : found.verdict) text += "verdict: " + verdict + "\n";
  return text;
}

}  // namespace impactdic::report
