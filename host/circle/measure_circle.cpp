// From a frame and what is known of it to a measured circle: followed by the rim model of earlier
// frames, or searched, traced and fitted, and its rim model learnt.
#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "host/circle/circle.h"
#include "host/circle/model_fit.h"
#include "host/circle/rim/rim.h"
#include "host/circle/rim/rim_levels.h"
#include "host/circle/settings/judgement.h"
#include "host/circle/settings/outline.h"
#include "host/circle/settings/rim_model.h"
#include "host/circle/settings/sphere.h"
#include "host/circle/sphere/disc_doubt.h"
#include "host/circle/sphere/sphere_lines.h"

namespace impactdic::circle {
namespace {

// See Circle::free_px. Ink on the rim makes gaps too: those are narrow. Points in the order of the
// angle.
double free_distance(const std::vector<float>& cos, const std::vector<float>& sin,
                     std::size_t points, const Rim& rim) {
  const float narrow = static_cast<float>(std::cos(kJudge.gap_deg * kRadPerDeg));
  double widest = 0;
  for (std::size_t a = 0; a < points; ++a) {
    const std::size_t b = a + 1 < points ? a + 1 : 0;
    const float along = cos[a] * cos[b] + sin[a] * sin[b];
    if (along > narrow) continue;
    const double gap = std::atan2(cos[a] * sin[b] - sin[a] * cos[b], along);
    widest = std::max(widest, gap < 0 ? gap + 2 * kPi : gap);
  }
  return points == 0 ? 0 : rim.r * std::max(0.0, std::cos(widest / 2));
}

void validate(const Frame& frame, const CirclePrior& prior, const CircleOptions& options) {
  options.validate();
  if (!(prior.predicted.r_px > 1) || !(prior.centre_sd_px >= 0)) {
    throw InvalidArgument("a circle's prior needs a radius above 1 px and a scatter >= 0");
  }
  if (frame.width() < 8 || frame.height() < 8) {
    throw InvalidArgument("a picture for a circle must be at least 8x8 pixels");
  }
}

// What both kinds of fit have. A blurred disc crosses its half level inside its rim: at R − σ²/2R
// (mean of the Rice distribution).
template <typename Fit>
void fill(const Fit& fit, double edge_sigma_px, double radius_bias_sd_px, CircleFit& result) {
  const double shrink = edge_sigma_px * edge_sigma_px / (2 * fit.rim.r);
  const auto sd = [&](int i) {
    return std::hypot(fit.sd[i], fit.own.follows[i] * radius_bias_sd_px);
  };
  result.circle = {fit.rim.cx, fit.rim.cy, fit.rim.r + shrink};
  result.cx_sd_px = sd(0);
  result.cy_sd_px = sd(1);
  result.r_sd_px = sd(2);
  result.ellipse = fit.ellipse;
  result.e1_px = fit.rim.e1;
  result.e2_px = fit.rim.e2;
  result.e1_sd_px = sd(3);
  result.e2_sd_px = sd(4);
  result.cx_with_r = fit.with_radius[0];
  result.cy_with_r = fit.with_radius[1];
  result.own_r_px = fit.own.r_px + shrink;
  result.own_r_sd_px = fit.own.r_sd_px;
  result.residual_px = fit.residual_px;
  result.rim_points = fit.points;
}

// Paint of a bright ball, or the background of a dark one, at the end of the camera's scale. How
// bright it would be is not known, nor then where half of that is.
bool is_over_exposed(const LineTrace::Levels& levels, Surface surface, bool bright, double scale) {
  const double paint =
      surface != Surface::kFlat ? levels.sphere.at(0, 0, 1) : static_cast<double>(levels.light[0]);
  const double most =
      bright ? paint : -*std::min_element(levels.ground.begin(), levels.ground.end());
  return most > kJudge.over_exposed * scale;
}

// How much more than all of the rim noise misplaces single arcs, and with them centre and shape:
// the paint's level and the ink that is learnt beside it err from place to place.
double of_arcs(const RimModel& model) {
  if (model.surface() != Surface::kFlat) return 1;
  const double ink = kLearning.of_noise * std::max(0.0, model.noise() - kLearning.usual_noise);
  return std::hypot(kLearning.model_error, kLearning.noise_in_arcs * ink) /
         std::hypot(kLearning.model_error, ink);
}

CircleFit describe(const Frame& frame, const ModelFit& m, const LineTrace& trace,
                   const CirclePrior& prior, bool bright) {
  CircleFit result;
  const double sigma = m.rim_model->edge_sigma_px();
  LineFit fit = m.fit;
  const double place = m.rim_model->place_sd_px(), arcs = place * of_arcs(*m.rim_model);
  const auto of_model = [&](int i) {
    return (i == 2 ? place : arcs) * std::sqrt(fit.misplaced[i]);
  };
  for (int i = 0; i < 5; ++i) fit.sd[i] = std::hypot(fit.sd[i], of_model(i));
  fit.own.r_sd_px = std::hypot(fit.own.r_sd_px, place * std::sqrt(fit.own.misplaced));
  fill(fit, sigma, prior.radius_bias_sd_px, result);
  result.shared_r_sd_px = std::hypot(of_model(2), fit.own.follows[2] * prior.radius_bias_sd_px);
  const bool arc = fit.points < kSphere.most_left * trace.in_view;
  if (m.rim_model->surface() != Surface::kFlat) {
    // Ink misplaces the rim alike all around; light does not, and bends it. What is darker than the
    // background may be the dark side of a ball.
    if (bright && is_evenly_lit(trace)) result.cx_with_r = result.cy_with_r = 0;
    const double usual = arc ? kSphere.radius_sd_of_r * result.circle.r_px : 0;
    widen(result, 0, std::max(m.rim_model->light_sd_px(), usual));
  }
  // What is left of a rim that fades is an arc: a light that is a little wrong moves its centre.
  if (m.rim_model->surface() == Surface::kSphere && fades(trace.levels) && arc) {
    result.cx_sd_px = std::hypot(result.cx_sd_px, kSphere.arc_sd_px);
    result.cy_sd_px = std::hypot(result.cy_sd_px, kSphere.arc_sd_px);
    result.r_sd_px = std::hypot(result.r_sd_px, kSphere.arc_sd_px);
  }
  if (is_over_exposed(trace.levels, m.rim_model->surface(), bright, frame.full_scale())) {
    result.r_sd_px = std::hypot(result.r_sd_px, kJudge.over_exposed_sd * sigma);
  }
  // What lies just outside the rim is guessed from what lies beside it.
  if (trace.breaks > kJudge.texture_breaks) widen(result, kJudge.texture_px, kJudge.texture_px);
  result.circle.free_px =
      free_distance(trace.lines.cos, trace.lines.sin, trace.lines.size(), m.fit.rim);
  result.bright = bright;
  result.rim_model = m.rim_model;
  result.rim_fraction = static_cast<double>(m.fit.points) / trace.cast;
  return result;
}

template <typename Fit>
bool is_enough(const Fit& fit) {
  return fit.ok && fit.points >= kJudge.least_points && fit.arc >= kJudge.least_arc;
}

// The fit with the status that its circle deserves.
CircleFit accepted(CircleFit fit, const Frame& frame, const CircleOptions& options) {
  const Circle& c = fit.circle;
  if (options.radius_range_px &&
      (c.r_px < options.radius_range_px->first || c.r_px > options.radius_range_px->second)) {
    return CircleFit{.bright = fit.bright};
  }
  const bool centre_in =
      c.cx_px >= 0 && c.cy_px >= 0 && c.cx_px <= frame.width() - 1 && c.cy_px <= frame.height() - 1;
  const bool in_region =
      centre_in && (!options.region || (*options.region)(static_cast<int>(std::lround(c.cx_px)),
                                                         static_cast<int>(std::lround(c.cy_px))));
  fit.status = in_region ? CircleStatus::kOk : CircleStatus::kOutOfView;
  return fit;
}

// By the prior's rim model, where there is one and the prediction is near enough; nullopt where the
// rim has to be searched.
std::optional<CircleFit> follow(const Frame& frame, const CirclePrior& prior,
                                const CircleOptions& options, LineTrace& lines) {
  if (!prior.rim_model || !prior.bright || !prior.rim_sd_px) return std::nullopt;
  const double oval = std::hypot(prior.e1_px, prior.e2_px);
  if (!(oval < kJudge.followed_oval * prior.predicted.r_px)) return std::nullopt;
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

// By the prior's rim model of a sphere, from where search or crossings found the rim. Crossings of
// the half level lie too far inside on a lit sphere, and on its dark side they may be wrong.
std::optional<CircleFit> follow_from(const Rim& found, const Frame& frame, CirclePrior prior,
                                     const CircleOptions& options, LineTrace& lines) {
  if (!prior.rim_model || prior.rim_model->surface() == Surface::kFlat) return std::nullopt;
  prior.e1_px = prior.e2_px = 0;
  // The last frame's radius is better known than what was found.
  constexpr double kSeek = kSphere.seek_px;
  const double steps[5][2] = {{0, 0}, {kSeek, 0}, {-kSeek, 0}, {0, kSeek}, {0, -kSeek}};
  for (const auto& [x, y] : steps) {
    prior.predicted = {found.cx + x, found.cy + y, prior.predicted.r_px};
    const ModelFit m = follow_rim(frame, prior, options, Approach::kAfterPreview, lines);
    if (is_enough(m.fit)) return describe(frame, m, lines, prior, *prior.bright);
  }
  return std::nullopt;
}

// Crossings of the half level about the rim that the search found, and the fit through them.
struct Crossings {
  RimFit fit;
  int rays = 0;         // of the last trace
  double moved_px = 0;  // from the rim that this was cast about
  double edge_sigma_px = 0;
};

Crossings trace_crossings(const Frame& frame, const RimSearch& search, const CirclePrior& prior,
                          const CircleOptions& options, RimTrace& trace) {
  Crossings m;
  m.fit.rim = search.rim;
  // Ink leaves the search too far off for a single trace: then the first one is a preview.
  bool sharp = prior.inked, preview = prior.inked;
  for (int pass = 0; pass < kJudge.traces; ++pass) {
    const Rim rim = m.fit.rim;
    m.rays = preview ? std::max(options.rays / kJudge.preview_of_rays, kJudge.preview_rays)
                     : options.rays;
    const Kernel kernel = sharp ? Kernel::kSharp : Kernel::kSmooth;
    trace_rim(frame, rim, {search.polarity, search.blur_px, kernel, m.rays}, trace);
    m.fit = fit_rim(trace, rim, prior, shapes_of(options));
    if (!m.fit.ok) break;
    m.moved_px = distance(m.fit.rim, rim);
    if (std::exchange(preview, false)) continue;
    const bool sharpen = !sharp && m.fit.inked > kJudge.dense;
    if (!sharpen && m.moved_px < kJudge.retrace_px) break;
    sharp |= sharpen;
  }
  m.edge_sigma_px = trace.edge_sigma_px;
  return m;
}

// What the crossings may misplace the rim of a sphere by: more where its radius is another than in
// the frame before. Ink in most edges and no model of it may be a sphere's, too. A fit that still
// moves as often as it is traced again is known no better than it moves.
void doubt_crossings(const CirclePrior& prior, const CircleOptions& options,
                     const Crossings& crossings, CircleFit& fit) {
  const auto moves = [&](double by_px) {
    for (double* sd : {&fit.cx_sd_px, &fit.cy_sd_px, &fit.r_sd_px}) *sd = std::hypot(*sd, by_px);
  };
  const bool sphere = prior.rim_model && prior.rim_model->surface() != Surface::kFlat;
  if (options.sphere.value_or(true) && (sphere || fit.inked)) {
    const double off = sphere ? fit.circle.r_px - prior.predicted.r_px : 0;
    widen(fit, kSphere.crossings_centre_px, kSphere.crossings_radius_px);
    moves(off);
  }
  if (crossings.moved_px >= kJudge.retrace_px) moves(crossings.moved_px);
  // A wide edge takes in more ink, and one that is wider along the ball's way is no Gaussian's.
  moves(kJudge.of_blur * std::max(0.0, crossings.edge_sigma_px - kJudge.sharp_px));
  // What no longer shows as an ellipse may still be one.
  if (!fit.ellipse) fit.r_sd_px = std::hypot(fit.r_sd_px, prior.e1_px, prior.e2_px);
}

double free_distance(const RimTrace& trace, const Rim& rim) {
  std::vector<float> cos, sin;
  for (const RimPoint& p : trace.points) {
    if (std::abs(p.excess) > kJudge.on_rim_px) continue;
    cos.push_back(p.cos);
    sin.push_back(p.sin);
  }
  return free_distance(cos, sin, cos.size(), rim);
}

// Whether what an outline tells is to be taken for what the crossings tell, or for a sphere's model
// learnt from them (`known`). A disc behind a bar shows little of itself, too.
bool replaces(const CircleFit& outlined, bool known, bool learn) {
  if (!outlined.rim_model) return !known && !learn;
  const Surface surface = outlined.rim_model->surface();
  return surface == Surface::kOutline || (!known && surface == Surface::kSphere);
}

// By its outline, where that shows at least `least_points` rays' worth of it.
std::optional<CircleFit> by_outline(const Frame& frame, const CirclePrior& prior,
                                    const CircleOptions& options, double least_points,
                                    LineTrace& lines) {
  const RimSearch search = search_outline(frame, prior, options);
  if (!search.found || search.support < kOutline.support) return std::nullopt;
  thread_local RimTrace trace;  // memory only
  RimFit fit;
  fit.rim = search.rim;
  for (int pass = 0; pass < kJudge.traces; ++pass) {
    const Rim rim = fit.rim;
    trace_outline(frame, rim, search.blur_px, options.rays, trace);
    fit = fit_outline(trace, rim);
    if (!fit.ok || distance(fit.rim, rim) < kJudge.retrace_px) break;
  }
  if (!is_enough(fit) || fit.points < least_points) return std::nullopt;
  const bool bright = search.polarity == Polarity::kBright;
  if (prior.bright && *prior.bright == bright) {
    if (const auto followed = follow_from(fit.rim, frame, prior, options, lines)) return followed;
  }
  ModelFit learnt;
  // A ball that is followed is worth the time: without a model an outline knows little.
  const bool followed = prior.radius_px.has_value();
  if (prior.learn || followed) learnt = learn_rim(frame, fit, search, prior, options, lines);
  CircleFit result;
  if (is_enough(learnt.fit)) {
    result = describe(frame, learnt, lines, prior, learnt.polarity == Polarity::kBright);
  } else {
    fill(fit, trace.edge_sigma_px, prior.radius_bias_sd_px, result);
    result.bright = bright;
    result.rim_fraction = static_cast<double>(fit.points) / options.rays;
    widen(result, kOutline.centre_sd_px, kOutline.radius_sd_px);
  }
  result.circle.free_px = free_distance(trace, fit.rim);
  return result;
}

}  // namespace

const char* to_string(CircleStatus status) {
  switch (status) {
    case CircleStatus::kOk:
      return "ok";
    case CircleStatus::kNoBall:
      return "no_ball";
    case CircleStatus::kOutOfView:
      return "out_of_view";
  }
  return "";
}

void CircleOptions::validate() const {
  if (rays < 64 || rays > 16384) {
    throw InvalidArgument("rays must be 64 to 16384", "CircleOptions::rays");
  }
  if (radius_range_px &&
      !(radius_range_px->first >= 3 && radius_range_px->second > radius_range_px->first)) {
    throw InvalidArgument("the radius range must be LO:HI with 3 <= LO < HI", "--radius-px");
  }
}

CircleFit measure_circle(const Frame& frame, const CirclePrior& prior,
                         const CircleOptions& options) {
  validate(frame, prior, options);
  thread_local LineTrace lines;  // memory only
  thread_local RimTrace trace;   // memory only
  if (const auto followed = follow(frame, prior, options, lines)) {
    return accepted(*followed, frame, options);
  }

  CirclePrior around = prior;
  around.centre_sd_px = std::max(prior.centre_sd_px, kJudge.least_search_px);
  const RimSearch search = search_rim(frame, around, options);
  const bool bright = search.polarity == Polarity::kBright;
  CircleFit result;
  result.bright = bright;
  if (search.in_view < kJudge.in_view) {
    result.status = CircleStatus::kOutOfView;
    return result;
  }
  Crossings crossings;
  if (search.found) crossings = trace_crossings(frame, search, prior, options, trace);
  if (search.found && trace.rays_in_view < kJudge.in_view * crossings.rays) {
    result.status = CircleStatus::kOutOfView;
    return result;
  }
  const RimFit& fit = crossings.fit;
  if (!is_enough(fit)) {
    const auto outlined = by_outline(frame, around, options, 0, lines);
    return outlined ? accepted(*outlined, frame, options) : result;
  }

  for (const Rim& found : {fit.rim, search.rim}) {
    if (!prior.bright || *prior.bright != bright) break;
    const auto followed = follow_from(found, frame, prior, options, lines);
    if (followed) return accepted(*followed, frame, options);
  }
  ModelFit learnt;
  if (prior.learn) learnt = learn_rim(frame, fit, search, prior, options, lines);
  const bool known = is_enough(learnt.fit);
  const bool whole = known && (learnt.rim_model->surface() == Surface::kFlat ||
                               learnt.fit.points > kSphere.most_left * lines.in_view);
  if (!whole && fit.points < kOutline.poor_rim * options.rays) {
    thread_local LineTrace others;  // memory only
    const double least = kOutline.more_rim * fit.points;
    const auto outlined = by_outline(frame, around, options, least, others);
    if (outlined && replaces(*outlined, known, prior.learn)) {
      return accepted(*outlined, frame, options);
    }
  }
  if (known) {
    result = describe(frame, learnt, lines, prior, learnt.polarity == Polarity::kBright);
  } else {
    fill(fit, trace.edge_sigma_px, prior.radius_bias_sd_px, result);
    result.rim_fraction = static_cast<double>(fit.points) / options.rays;
  }
  // Crossings end more sharply at what hides the rim.
  result.circle.free_px = free_distance(trace, fit.rim);
  result.inked = fit.inked > kJudge.dense;
  if (!result.rim_model) doubt_crossings(prior, options, crossings, result);
  return accepted(result, frame, options);
}

}  // namespace impactdic::circle
