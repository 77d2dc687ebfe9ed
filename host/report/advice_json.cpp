#include "host/report/advice_json.h"

#include <impactdic/units.h>

#include <nlohmann/json.hpp>

#include "host/base/json_number.h"

namespace impactdic::report {
namespace {

using nlohmann::json;

json describe(const SizeAdvice& size) {
  return {{"window_px", size.window_px},
          {"windows", size.windows},
          {"usable", size.usable},
          {"expected_error_px", json_number(size.error_px)},
          {"contrast", json_number(size.contrast)}};
}

}  // namespace

json describe_advice(const ClipAdvice& advice) {
  json out = {{"frames_looked_at", advice.frames}, {"frames_with_ball", advice.frames_with_ball}};
  out["edge_width_px"] = json_number(advice.edge_px.value_or(kNotMeasured));
  out["turn_deg_per_frame"] = json_number(advice.turn_deg.value_or(kNotMeasured));
  if (!advice.texture) return out;
  const TextureAdvice& texture = *advice.texture;
  out["noise"] = texture.noise;
  out["windows"] = describe(texture.asked);
  for (const SizeAdvice& size : texture.sizes) out["window_sizes"].push_back(describe(size));
  if (texture.ball) {
    out["ball"] = {{"dx_sd_px", json_number(texture.ball->dx_sd_px)},
                   {"dy_sd_px", json_number(texture.ball->dy_sd_px)},
                   {"rot_sd_deg", json_number(texture.ball->rot_sd_rad * kDegPerRad)}};
  }
  return out;
}

}  // namespace impactdic::report
