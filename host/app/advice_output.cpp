#include "host/app/advice_output.h"

#include <impactdic/units.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace impactdic::app {
namespace {

using nlohmann::json;

json number(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

json describe(const SizeAdvice& size) {
  return {{"window_px", size.window_px},
          {"windows", size.windows},
          {"usable", size.usable},
          {"expected_error_px", number(size.error_px)},
          {"contrast", number(size.contrast)}};
}

template <typename... Values>
std::string say(const char* format, Values... values) {
  char text[240];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

std::string in_words(const SizeAdvice& size) {
  std::string text = say("%d windows of %d px, %.0f %% usable", size.windows, size.window_px,
                         100 * size.usable_share());
  if (size.usable > 0) text += say(", %.4f px expected of each", size.error_px);
  return text;
}

}  // namespace

json describe_advice(const ClipAdvice& advice) {
  json out = {{"frames_looked_at", advice.frames}, {"frames_with_ball", advice.frames_with_ball}};
  out["edge_width_px"] = number(advice.edge_px.value_or(kNotMeasured));
  out["turn_deg_per_frame"] = number(advice.turn_deg.value_or(kNotMeasured));
  if (!advice.texture) return out;
  const TextureAdvice& texture = *advice.texture;
  out["noise"] = texture.noise;
  out["windows"] = describe(texture.asked);
  for (const SizeAdvice& size : texture.sizes) out["window_sizes"].push_back(describe(size));
  if (texture.ball) {
    out["ball"] = {{"dx_sd_px", number(texture.ball->dx_sd_px)},
                   {"dy_sd_px", number(texture.ball->dy_sd_px)},
                   {"rot_sd_deg", number(texture.ball->rot_sd_rad * kDegPerRad)}};
  }
  return out;
}

std::vector<std::pair<std::string, std::string>> advice_lines(const ClipAdvice& advice,
                                                              double error_px) {
  std::vector<std::pair<std::string, std::string>> lines;
  if (advice.ball) {
    lines.emplace_back("ball", say("radius %.1f px, in %d of %d frames looked at",
                                   advice.ball->r_px, advice.frames_with_ball, advice.frames));
  }
  if (!advice.texture) return lines;
  const TextureAdvice& texture = *advice.texture;
  lines.emplace_back("noise", say("%.2f grey levels of 255", texture.noise));
  lines.emplace_back("texture", in_words(texture.asked));
  for (const SizeAdvice& size : texture.sizes) {
    if (size.window_px != texture.asked.window_px) lines.emplace_back("", in_words(size));
  }
  const int enough = window_reaching(texture, error_px);
  lines.emplace_back("window", enough > 0 ? say("%d px reach %g px a window", enough, error_px)
                                          : say("no size reaches %g px a window", error_px));
  if (texture.ball && std::isfinite(texture.ball->dx_sd_px)) {
    lines.emplace_back(
        "whole ball",
        say("%.4f px and %.4f deg expected (--estimator ball)",
            std::hypot(texture.ball->dx_sd_px, texture.ball->dy_sd_px) / std::sqrt(2.0),
            texture.ball->rot_sd_rad * kDegPerRad));
  }
  return lines;
}

std::vector<std::string> all_warnings(const VideoRequest& request, const ClipInfo& info,
                                      const ClipAdvice& advice) {
  std::vector<std::string> warnings;
  for (const std::string& warning : info.warnings) {
    const bool answered = request.fps > 0 && warning.find("--fps") != std::string::npos;
    if (!answered) warnings.push_back(warning);
  }
  warnings.insert(warnings.end(), advice.warnings.begin(), advice.warnings.end());
  return warnings;
}

void print_advice(const ClipAdvice& advice, const std::vector<std::string>& warnings) {
  if (advice.texture) {
    std::fprintf(stderr, "impactdic: texture: %s\n", in_words(advice.texture->asked).c_str());
  }
  for (const std::string& warning : warnings) {
    std::fprintf(stderr, "impactdic: warning: %s\n", warning.c_str());
  }
}

}  // namespace impactdic::app
