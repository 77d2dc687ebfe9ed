#include "host/circle/sphere/rim_bias.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/base/statistics.h"
#include "host/circle/rim/rim_model.h"
#include "host/circle/settings/sphere.h"

namespace impactdic::circle {
namespace {

bool is_lit(const CircleFit& fit) { return fit.rim_model->surface() != Surface::kFlat; }

}  // namespace

RimBias::RimBias(const std::array<double, 4>& numbers)
    : off_px(numbers[0]), shared_sd_px(numbers[1]), chance_sd_px(numbers[2]), lit(numbers[3] != 0) {
  if (!std::isfinite(off_px) || !(shared_sd_px > 0) || !std::isfinite(shared_sd_px) ||
      !(chance_sd_px >= 0) || !std::isfinite(chance_sd_px)) {
    throw InvalidArgument("this is no bias of a rim", "resume");
  }
}

std::array<double, 4> RimBias::numbers() const {
  return {off_px, shared_sd_px, chance_sd_px, lit ? 1.0 : 0.0};
}

std::optional<RimBias> rim_bias(std::span<const double> radii_px, const CircleFit& like,
                                const Measured& by_turns) {
  if (radii_px.empty() || !like.rim_model || !(like.shared_r_sd_px > 0)) return std::nullopt;
  const double centre = upper_median(std::vector<double>(radii_px.begin(), radii_px.end()));
  std::vector<double> off;
  for (const double r : radii_px) off.push_back(std::abs(r - centre));
  const double scatter = kSdOfMad * upper_median(std::move(off));
  RimBias bias;
  bias.off_px = centre - by_turns.value;
  bias.shared_sd_px = like.shared_r_sd_px;
  bias.chance_sd_px =
      std::hypot(by_turns.sd, scatter / std::sqrt(static_cast<double>(radii_px.size())));
  bias.lit = is_lit(like);
  const double allowed = kSphere.bias_sds * std::hypot(bias.shared_sd_px, bias.chance_sd_px);
  // Either may be wrong: half of the way, known to be one of its ends.
  if (std::abs(bias.off_px) > allowed)
    bias.shared_sd_px = bias.chance_sd_px = std::abs(bias.off_px);
  return bias;
}

void take_off(const RimBias& bias, CircleFit& fit) {
  if (fit.status != CircleStatus::kOk || !fit.rim_model || is_lit(fit) != bias.lit) return;
  const double shared = bias.shared_sd_px * bias.shared_sd_px;
  const double chance = bias.chance_sd_px * bias.chance_sd_px;
  const double told = shared / (shared + chance);
  fit.circle.r_px -= told * bias.off_px;
  fit.own_r_px -= told * bias.off_px;
  const double own = fit.shared_r_sd_px * fit.shared_r_sd_px;
  fit.r_sd_px =
      std::sqrt(std::max(0.0, fit.r_sd_px * fit.r_sd_px - std::min(own, shared)) + told * chance);
}

}  // namespace impactdic::circle
