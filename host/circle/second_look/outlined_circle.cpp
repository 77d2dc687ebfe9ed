#include "host/circle/second_look/outlined_circle.h"

#include <cmath>
#include <memory>
#include <utility>

#include "host/circle/describe_fit.h"
#include "host/circle/follow_circle.h"
#include "host/circle/model_fit.h"
#include "host/circle/rim/rim.h"
#include "host/circle/rim/rim_model.h"
#include "host/circle/second_look/rim_beyond.h"
#include "host/circle/settings/beyond.h"
#include "host/circle/settings/judgement.h"
#include "host/circle/settings/outline.h"
#include "host/circle/sphere/disc_doubt.h"

namespace impactdic::circle {
namespace {

// What an outline must show to be one.
struct LeastOutline {
  double support = kOutline.support;  // RimSearch::support
  double points = 0;                  // rays' worth of it
  Departures departures = Departures::kPooled;
};

// The rim model about an outline. Before a background between a ball's paint and its ink, that
// does not tell which of them is to be taken for the paint: the one that differs more from the
// background stands out of the noise more. What an evened texture leaves is of either kind, and a
// ball that was learnt before is as it was.
ModelFit learn_either_way(const Frame& frame, const RimFit& known, RimSearch search,
                          const CirclePrior& prior, const CircleOptions& options,
                          LineTrace& lines) {
  ModelFit learnt = learn_rim(frame, known, search, prior, options, lines);
  if (options.evened || prior.rim_model) return learnt;
  search.polarity = opposite(search.polarity);
  thread_local LineTrace others;  // memory only
  ModelFit other = learn_rim(frame, known, search, prior, options, others);
  if (!is_enough(other.fit)) return learnt;
  if (is_enough(learnt.fit) && lines.levels.usual > others.levels.usual) return learnt;
  std::swap(lines, others);
  return other;
}

std::optional<CircleFit> by_outline(const Frame& frame, const CirclePrior& prior,
                                    const CircleOptions& options, const LeastOutline& least,
                                    LineTrace& lines) {
  const RimSearch search = search_outline(frame, prior, options, least.departures);
  if (!search.found || search.support < least.support) return std::nullopt;
  thread_local RimTrace trace;  // memory only
  RimFit fit;
  fit.rim = search.rim;
  int of_rays = 1;
  for (int pass = 0; pass < kJudge.traces; ++pass) {
    const Rim rim = fit.rim;
    if (least.departures == Departures::kPooled &&
        trace_pooled_outline(frame, rim, search.blur_px, options.rays / kOutline.of_usual_rays,
                             trace)) {
      of_rays = kOutline.of_usual_rays;
    } else {
      trace_outline(frame, rim, search.blur_px, options.rays, trace);
      of_rays = 1;
    }
    fit = fit_outline(trace, rim);
    if (!fit.ok || !(fit.rim.r > 1)) return std::nullopt;
    if (distance(fit.rim, rim) < kJudge.retrace_px) break;
  }
  if (!is_enough(fit) || fit.points * of_rays < least.points) return std::nullopt;
  const bool bright = search.polarity == Polarity::kBright;
  if (prior.bright && *prior.bright == bright) {
    if (const auto followed = follow_sphere_from(fit.rim, frame, prior, options, lines))
      return followed;
  }
  ModelFit learnt;
  // A ball that is followed is worth the time: without a model an outline knows little.
  const bool followed = prior.radius_px.has_value();
  if (prior.learn || followed) {
    learnt = learn_either_way(frame, fit, search, prior, options, lines);
  }
  CircleFit result;
  if (is_enough(learnt.fit)) {
    result = describe(frame, learnt, lines, prior, learnt.polarity == Polarity::kBright);
  } else {
    fill(fit, trace.edge_sigma_px, prior.radius_bias_sd_px, result);
    result.bright = bright;
    result.rim_fraction = static_cast<double>(fit.points * of_rays) / options.rays;
    widen(result, kOutline.centre_sd_px, kOutline.radius_sd_px);
  }
  result.circle.free_px = free_distance(trace, fit.rim);
  return result;
}

// What of the ball shows outside a circle.
Beyond beyond_circle(const Frame& frame, const CircleFit& fit) {
  return beyond_rim(frame, rim_of(fit),
                    fit.rim_model ? fit.rim_model->edge_sigma_px() : kBeyond.usual_sigma_px);
}

// The ball in the surroundings of a circle that is not its own.
std::optional<CircleFit> ball_about(const Frame& frame, const CircleFit& fit, CirclePrior prior,
                                    CircleOptions options, LineTrace& lines) {
  look_about(fit, kBeyond.look_of_r, prior, options);
  return by_outline(frame, prior, options, {.support = kBeyond.support}, lines);
}

// Beside what hid a rim from the first look a part of it may be no rim, and the model does not
// tell.
CircleFit doubted(CircleFit fit) {
  if (!fit.rim_model) return fit;
  auto model = std::make_shared<RimModel>(fit.rim_model->numbers());
  model->set_place_sd_px(std::hypot(model->place_sd_px(), kBeyond.hidden_sd_px));
  fit.rim_model = std::move(model);
  for (double* sd : {&fit.cx_sd_px, &fit.cy_sd_px, &fit.r_sd_px}) {
    *sd = std::hypot(*sd, kBeyond.hidden_sd_px);
  }
  return fit;
}

}  // namespace

void look_about(const CircleFit& fit, double of_r, CirclePrior& prior, CircleOptions& options) {
  prior.predicted = fit.circle;
  prior.e1_px = prior.e2_px = 0;
  prior.centre_sd_px = of_r * fit.circle.r_px;
  prior.rim_sd_px = prior.centre_sd_px;
  options.allow_ellipse = false;
}

// What an evened texture leaves is not background, and not the ball either: it is not pooled. A bar
// that is not seen leaves a part of a disc, whose ink tells no radius beside it.
std::optional<CircleFit> outlined_circle(const Frame& frame, const CirclePrior& prior,
                                         const CircleOptions& options, double least_points,
                                         LineTrace& lines) {
  LeastOutline least{.points = least_points};
  if (!options.evened) {
    const auto pooled = by_outline(frame, prior, options, least, lines);
    const bool flat = pooled && pooled->rim_model && pooled->rim_model->surface() == Surface::kFlat;
    if (pooled && !flat) return pooled;
  }
  least.departures = Departures::kClear;
  return by_outline(frame, prior, options, least, lines);
}

CircleFit with_all_inside(CircleFit fit, const Frame& frame, const CirclePrior& prior,
                          const CircleOptions& options, LineTrace& lines) {
  if (fit.status != CircleStatus::kOk || options.evened) return fit;
  if (!fit.rim_model && fit.rim_fraction > kBeyond.whole_rim &&
      fit.residual_px < kBeyond.whole_residual_px) {
    return fit;
  }
  Beyond beyond = beyond_circle(frame, fit);
  if (beyond.share < kBeyond.share) return fit;
  if (const auto other = ball_about(frame, fit, prior, options, lines)) {
    CircleFit next = accepted(*other, frame, options);
    const Beyond left = beyond_circle(frame, next);
    // Of two circles that nothing else proves that with more of a rim is the ball's.
    const bool shows_more = prior.learn || next.rim_fraction > fit.rim_fraction;
    if (next.status == CircleStatus::kOk && shows_more &&
        left.share < kBeyond.less * beyond.share) {
      fit = doubted(std::move(next));
      beyond = left;
    }
  }
  if (!fit.rim_model) {
    const double off_px = beyond.share * beyond.farthest_px;
    if (off_px > kBeyond.most_of_r * fit.circle.r_px) {
      return CircleFit{.bright = fit.bright};
    }
    for (double* sd : {&fit.cx_sd_px, &fit.cy_sd_px, &fit.r_sd_px}) *sd = std::hypot(*sd, off_px);
  }
  return fit;
}

}  // namespace impactdic::circle
