#include "host/circle/follow_circle.h"

#include <cmath>

#include "host/circle/describe_fit.h"
#include "host/circle/model_fit.h"
#include "host/circle/rim/rim_model.h"
#include "host/circle/settings/judgement.h"
#include "host/circle/settings/sphere.h"

namespace impactdic::circle {

std::optional<CircleFit> follow(const Frame& frame, const CirclePrior& prior,
                                const CircleOptions& options, LineTrace& lines) {
  if (!prior.rim_model || !prior.bright || !prior.rim_sd_px) return std::nullopt;
  const double oval = std::hypot(prior.e1_px, prior.e2_px);
  const bool sphere = prior.rim_model->surface() != Surface::kFlat;
  if (!sphere && !(oval < kJudge.followed_oval * prior.predicted.r_px)) return std::nullopt;
  const double step_px = prior.rim_model->step_px();
  const double scatter = std::hypot(prior.centre_sd_px, *prior.rim_sd_px);
  if (!(scatter < kJudge.close_steps * step_px)) return std::nullopt;
  ModelFit m;
  if (prior.centre_sd_px < kJudge.near_steps * step_px) {
    m = follow_rim(frame, prior, options, Approach::kAtOnce, lines);
  }
  if (!is_enough(m.fit)) m = follow_rim(frame, prior, options, Approach::kAfterPreview, lines);
  if (!is_enough(m.fit)) return std::nullopt;
  CircleFit fit = describe(frame, m, lines, prior, *prior.bright);
  // Of a sphere it is the light that shows more of the rim or less.
  const bool flat = m.rim_model->surface() == Surface::kFlat;
  if (flat && fit.rim_fraction < kJudge.followed_rim * prior.rim_fraction) return std::nullopt;
  return fit;
}

std::optional<CircleFit> follow_disc_from(const Rim& found, const Frame& frame, CirclePrior prior,
                                          const CircleOptions& options, LineTrace& lines) {
  if (!prior.rim_model || prior.rim_model->surface() != Surface::kFlat) return std::nullopt;
  prior.predicted = {found.cx, found.cy, found.r};
  prior.e1_px = found.e1;
  prior.e2_px = found.e2;
  const ModelFit m = follow_rim(frame, prior, options, Approach::kAfterPreview, lines);
  if (!is_enough(m.fit)) return std::nullopt;
  CircleFit fit = describe(frame, m, lines, prior, *prior.bright);
  if (fit.rim_fraction < kJudge.followed_rim * prior.rim_fraction) return std::nullopt;
  return fit;
}

std::optional<CircleFit> follow_sphere_from(const Rim& found, const Frame& frame, CirclePrior prior,
                                            const CircleOptions& options, LineTrace& lines) {
  if (!prior.rim_model || prior.rim_model->surface() == Surface::kFlat) return std::nullopt;
  const auto from = [&](double x, double y) -> std::optional<CircleFit> {
    prior.predicted.cx_px = x;
    prior.predicted.cy_px = y;
    const ModelFit m = follow_rim(frame, prior, options, Approach::kAfterPreview, lines);
    if (!is_enough(m.fit)) return std::nullopt;
    return describe(frame, m, lines, prior, *prior.bright);
  };
  const double oval = std::hypot(prior.e1_px, prior.e2_px), r = prior.predicted.r_px;
  if (oval > kJudge.followed_oval * r) {
    // In contact: about as in the last frame, then pressed more or less.
    const CirclePrior last = prior;
    const double step_px = kJudge.shapes_apart * (r + oval);
    for (const int steps : {0, 1, -1, 2, -2}) {
      const double pressed_px = oval + steps * step_px;
      if (pressed_px < 0) continue;
      prior.predicted.r_px = r + oval - pressed_px;
      prior.e1_px = last.e1_px * pressed_px / oval;
      prior.e2_px = last.e2_px * pressed_px / oval;
      if (auto fit = from(found.cx, found.cy)) return fit;
    }
    prior = last;
  }
  // The last frame's radius is better known than what was found.
  prior.e1_px = prior.e2_px = 0;
  constexpr double kSeek = kSphere.seek_px;
  const double steps[5][2] = {{0, 0}, {kSeek, 0}, {-kSeek, 0}, {0, kSeek}, {0, -kSeek}};
  for (const auto& [x, y] : steps) {
    if (auto fit = from(found.cx + x, found.cy + y)) return fit;
  }
  return std::nullopt;
}

}  // namespace impactdic::circle
