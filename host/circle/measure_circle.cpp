// From a frame and what is known of it to a measured circle: followed by the rim model of earlier
// frames, or searched, traced and fitted, and its rim model learnt.
#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "host/circle/circle.h"
#include "host/circle/describe_fit.h"
#include "host/circle/follow_circle.h"
#include "host/circle/model_fit.h"
#include "host/circle/rim/rim.h"
#include "host/circle/rim/rim_levels.h"
#include "host/circle/second_look/outlined_circle.h"
#include "host/circle/settings/judgement.h"
#include "host/circle/settings/outline.h"
#include "host/circle/settings/sphere.h"
#include "host/circle/sphere/disc_doubt.h"

namespace impactdic::circle {
namespace {

void validate(const Frame& frame, const CirclePrior& prior, const CircleOptions& options) {
  options.validate();
  if (!(prior.predicted.r_px > 1) || !(prior.centre_sd_px >= 0)) {
    throw InvalidArgument("a circle's prior needs a radius above 1 px and a scatter >= 0");
  }
  if (frame.width() < 8 || frame.height() < 8) {
    throw InvalidArgument("a picture for a circle must be at least 8x8 pixels");
  }
}

// An oval as a surface makes it of the ball: its long axis is the free ball's.
bool is_pressed(const Rim& rim, const CirclePrior& prior) {
  const double oval = std::hypot(rim.e1, rim.e2), r = prior.radius_px.value_or(0);
  return oval > kJudge.followed_oval * r && std::abs(rim.r + oval - r) < kJudge.pressed_long * r;
}

// In contact a ball changes its shape by more than a search looks about its last one: then it is
// looked for in all shapes from the free ball's to one that is pressed more, along the same axis.
// Only a known disc: other things beside a ball make ovals, too.
RimSearch search_shapes(const Frame& frame, const CirclePrior& prior,
                        const CircleOptions& options) {
  RimSearch best = search_rim(frame, prior, options);
  const double oval = std::hypot(prior.e1_px, prior.e2_px), r = prior.predicted.r_px;
  if (options.sphere != false || !is_pressed(rim_of(prior), prior)) return best;
  const double free_px = r + oval, step_px = kJudge.shapes_apart * free_px;
  const double most_px = oval + kJudge.pressed_more * free_px;
  for (double pressed_px = 0; pressed_px < most_px; pressed_px += step_px) {
    CirclePrior shape = prior;
    shape.predicted.r_px = free_px - pressed_px;
    shape.e1_px *= pressed_px / oval;
    shape.e2_px *= pressed_px / oval;
    const RimSearch other = search_rim(frame, shape, options);
    if (other.found && other.support > best.support) best = other;
  }
  return best;
}

// Crossings of the half level about the rim that the search found, and the fit through them.
struct Crossings {
  RimFit fit;
  int rays = 0;         // of the last trace
  double moved_px = 0;  // from the rim that this was cast about
  double edge_sigma_px = 0;
  bool over_exposed = false;
  GroundRise rise;
};

Crossings trace_crossings(const Frame& frame, const RimSearch& search, const CirclePrior& prior,
                          const CircleOptions& options, RimTrace& trace) {
  Crossings m;
  m.fit.rim = search.rim;
  // Of other balls nobody knows that it is one before a texture, and not a thing among others.
  const bool textured = options.sphere == false && !options.evened;
  // Ink leaves the search too far off for a single trace: then the first one is a preview.
  bool sharp = prior.inked, preview = prior.inked;
  for (int pass = 0; pass < kJudge.traces; ++pass) {
    const Rim rim = m.fit.rim;
    m.rays = preview ? std::max(options.rays / kJudge.preview_of_rays, kJudge.preview_rays)
                     : options.rays;
    const Kernel kernel = sharp ? Kernel::kSharp : Kernel::kSmooth;
    trace_rim(frame, rim, {search.polarity, search.blur_px, kernel, m.rays, textured}, trace);
    m.fit = fit_rim(trace, rim, prior, shapes_of(options));
    if (!m.fit.ok) break;
    m.moved_px = distance(m.fit.rim, rim);
    if (std::exchange(preview, false)) continue;
    const bool sharpen = !sharp && m.fit.inked > kJudge.dense;
    if (!sharpen && m.moved_px < kJudge.retrace_px) break;
    sharp |= sharpen;
  }
  m.edge_sigma_px = trace.edge_sigma_px;
  m.rise = trace.rise;
  m.over_exposed = is_over_exposed(trace.brightest, frame);
  return m;
}

// What no model of the ink took off. A texture behind the ball scatters points by more than ink
// does, and deviations are made of that.
void doubt_ink(CircleFit& fit) {
  const double part = std::min(1.0, std::pow(kJudge.inked_px / fit.residual_px, 4));
  const auto times = [&](double most) { return std::sqrt(1 + part * (most * most - 1)); };
  fit.cx_sd_px *= times(kJudge.inked_centre);
  fit.cy_sd_px *= times(kJudge.inked_centre);
  fit.r_sd_px *= times(kJudge.inked_radius);
}

// Of a rim that no model was found to hold for. What hides a part of it ends where crossings look
// like the rim's, which turns the arc that is left. A few speckles are much of a small ball's rim.
void doubt_unlearnt(CircleFit& fit) {
  const double per_r2 = 1 / (fit.circle.r_px * fit.circle.r_px);
  const double by_ink_px = kJudge.crossed_px3 * per_r2;
  widen(fit, by_ink_px,
        by_ink_px + (is_cut(fit) ? kJudge.cut_arc_px + kJudge.cut_arc_px3 * per_r2 : 0));
}

// What a rim model and crossings that know nothing of it differ by, either may err by.
void doubt_by(const Rim& crossings, CircleFit& fit) {
  const auto apart = [](double of_model, double of_crossings, double& sd) {
    sd = std::hypot(sd, kJudge.of_apart * (of_model - of_crossings));
  };
  apart(fit.circle.cx_px, crossings.cx, fit.cx_sd_px);
  apart(fit.circle.cy_px, crossings.cy, fit.cy_sd_px);
  apart(fit.circle.r_px, crossings.r, fit.r_sd_px);
}

// What the crossings may misplace the rim of a sphere by: more where its radius is another than in
// the frame before. Ink in most edges and no model of it may be a sphere's, too. A fit that still
// moves as often as it is traced again is known no better than it moves.
void doubt_crossings(const CirclePrior& prior, const CircleOptions& options,
                     const Crossings& crossings, CircleFit& fit) {
  const auto moves = [&](double by_px) {
    for (double* sd : {&fit.cx_sd_px, &fit.cy_sd_px, &fit.r_sd_px}) *sd = std::hypot(*sd, by_px);
  };
  if (fit.inked) doubt_ink(fit);
  const bool sphere = prior.rim_model && prior.rim_model->surface() != Surface::kFlat;
  if (options.sphere.value_or(true) && (sphere || fit.inked)) {
    const double off = sphere ? fit.circle.r_px - prior.predicted.r_px : 0;
    widen(fit, kSphere.crossings_centre_px, kSphere.crossings_radius_px);
    moves(off);
  }
  if (crossings.moved_px >= kJudge.retrace_px) moves(crossings.moved_px);
  // A wide edge takes in more ink, and one that is wider along the ball's way is no Gaussian's.
  const double wider_px = std::max(0.0, crossings.edge_sigma_px - kJudge.sharp_px);
  fit.cx_sd_px = std::hypot(fit.cx_sd_px, kJudge.of_blur_centre * wider_px);
  fit.cy_sd_px = std::hypot(fit.cy_sd_px, kJudge.of_blur_centre * wider_px);
  fit.r_sd_px = std::hypot(fit.r_sd_px, kJudge.of_blur * wider_px);
  if (crossings.over_exposed) {
    fit.r_sd_px = std::hypot(fit.r_sd_px, kJudge.over_exposed_sd * crossings.edge_sigma_px);
  }
  fit.cx_sd_px = std::hypot(fit.cx_sd_px, kJudge.crossed_of_rise_px * crossings.rise.x);
  fit.cy_sd_px = std::hypot(fit.cy_sd_px, kJudge.crossed_of_rise_px * crossings.rise.y);
  if (prior.learn || prior.unlearnt) doubt_unlearnt(fit);
  // Of arcs of several things a circle was made as often as of one.
  const bool arc = fit.rim_fraction <= kJudge.much_rim;
  const double most = arc ? kJudge.ragged_arc : kJudge.ragged;
  if (fit.residual_px > most * std::max(crossings.edge_sigma_px, kJudge.usual_px)) {
    moves(kJudge.ragged_sd_of_r * fit.circle.r_px);
  }
  // What no longer shows as an ellipse may still be one.
  if (!fit.ellipse) fit.r_sd_px = std::hypot(fit.r_sd_px, prior.e1_px, prior.e2_px);
}

// Whether what an outline tells is to be taken for what the crossings tell, or for a sphere's model
// learnt from them (`known`). A disc behind a bar shows little of itself, too.
bool replaces(const CircleFit& outlined, bool known, bool learn) {
  if (!outlined.rim_model) return !known && !learn;
  const Surface surface = outlined.rim_model->surface();
  return surface == Surface::kOutline || (!known && surface == Surface::kSphere);
}

// A sphere's model about where the rim was found, by crossings and by the search. It knows circles
// alone: of an oval it fits what the circle has in common with it, and lets the rest be dark.
std::optional<CircleFit> follow_found(const Crossings& crossings, const Rim& searched,
                                      const Frame& frame, const CirclePrior& prior,
                                      const CircleOptions& options, LineTrace& lines) {
  for (const Rim& found : {crossings.fit.rim, searched}) {
    const auto followed = follow_sphere_from(found, frame, prior, options, lines);
    if (!followed) continue;
    const double shown = crossings.fit.points / static_cast<double>(options.rays);
    const bool pressed = is_pressed(crossings.fit.rim, prior) && shown > followed->rim_fraction;
    return pressed ? std::nullopt : followed;
  }
  return std::nullopt;
}

// A ball in contact by the free ball's rim model, where what a floor leaves of the rim teaches
// none.
std::optional<CircleFit> follow_pressed(const Rim& crossings, const Frame& frame,
                                        const CirclePrior& prior, const CircleOptions& options,
                                        LineTrace& lines) {
  auto followed = follow_disc_from(crossings, frame, prior, options, lines);
  if (!followed) return std::nullopt;
  doubt_by(crossings, *followed);
  // The ink under the rim is no longer that of the free ball.
  const double by_ink_px = kJudge.crossed_px3 / (followed->circle.r_px * followed->circle.r_px);
  widen(*followed, by_ink_px, by_ink_px);
  return followed;
}

// By its outline, where crossings and what was learnt from them tell little of the rim.
std::optional<CircleFit> outlined_instead(const Crossings& crossings, const ModelFit& learnt,
                                          int lines_in_view, const Frame& frame,
                                          const CirclePrior& around, const CircleOptions& options) {
  const RimFit& fit = crossings.fit;
  const bool known = is_enough(learnt.fit);
  const bool whole = known && (learnt.rim_model->surface() == Surface::kFlat ||
                               learnt.fit.points > kSphere.most_left * lines_in_view);
  // An outline is a circle: of a disc that is plainly pressed it is another thing's.
  const bool disc = around.rim_model && around.rim_model->surface() == Surface::kFlat;
  const bool oval = disc && fit.ellipse && is_pressed(fit.rim, around) &&
                    fit.residual_px < kJudge.clean_px && fit.arc > kJudge.much_rim;
  if (whole || oval || fit.points >= kOutline.poor_rim * options.rays) return std::nullopt;
  thread_local LineTrace others;  // memory only
  const double least = kOutline.more_rim * fit.points;
  const auto outlined = outlined_circle(frame, around, options, least, others);
  const bool better = outlined && replaces(*outlined, known, around.learn);
  return better ? outlined : std::nullopt;
}

// By search and crossings, or by its outline; its rim model learnt.
CircleFit measure_anew(const Frame& frame, const CirclePrior& prior, const CircleOptions& options,
                       LineTrace& lines) {
  thread_local RimTrace trace;  // memory only
  CirclePrior around = prior;
  around.centre_sd_px = std::max(prior.centre_sd_px, kJudge.least_search_px);
  const RimSearch search = search_shapes(frame, around, options);
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
  const bool as_before = search.found && prior.bright && *prior.bright == bright;
  if (!is_enough(fit)) {
    auto told =
        as_before ? follow_disc_from(search.rim, frame, prior, options, lines) : std::nullopt;
    if (!told) told = outlined_circle(frame, around, options, 0, lines);
    return told ? accepted(*told, frame, options) : result;
  }
  if (as_before) {
    const auto followed = follow_found(crossings, search.rim, frame, prior, options, lines);
    if (followed) return accepted(*followed, frame, options);
  }
  ModelFit learnt;
  if (prior.learn) learnt = learn_rim(frame, fit, search, prior, options, lines);
  const bool known = is_enough(learnt.fit);
  const bool flat = known && learnt.rim_model->surface() == Surface::kFlat;
  if (as_before && !flat && fit.ellipse && is_pressed(fit.rim, prior)) {
    const auto followed = follow_pressed(fit.rim, frame, prior, options, lines);
    if (followed) return accepted(*followed, frame, options);
  }
  if (const auto outlined =
          outlined_instead(crossings, learnt, lines.in_view, frame, around, options)) {
    return accepted(*outlined, frame, options);
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

// A wider look about a circle for which no model and little of a rim speaks: beside a bar, or
// before a texture, the arc that was found may be a part of a larger rim. One elsewhere that shows
// most of itself is the ball's.
CircleFit with_more_rim(CircleFit fit, const Frame& frame, CirclePrior prior, CircleOptions options,
                        LineTrace& lines) {
  if (fit.status != CircleStatus::kOk || fit.rim_model) return fit;
  if (fit.rim_fraction > kJudge.much_rim && fit.residual_px < kJudge.scattered_px) return fit;
  if (fit.rim_fraction > kJudge.clean_rim && fit.residual_px < kJudge.clean_px) return fit;
  look_about(fit, kJudge.wider_of_r, prior, options);
  CircleFit other = measure_anew(frame, prior, options, lines);
  const auto length = [](const CircleFit& f) { return f.rim_fraction * f.circle.r_px; };
  const bool shows_more = other.status == CircleStatus::kOk &&
                          other.rim_fraction > std::max(fit.rim_fraction, kJudge.much_rim) &&
                          length(other) > kJudge.more_rim * length(fit);
  return shows_more && distance(rim_of(other), rim_of(prior)) > kJudge.another_px ? other : fit;
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
  if (const auto followed = follow(frame, prior, options, lines)) {
    return accepted(*followed, frame, options);
  }
  CircleFit fit = measure_anew(frame, prior, options, lines);
  // Second looks are for circles: of a ball in contact they find one that passes over what the
  // surface flattens.
  if (fit.ellipse && is_pressed(rim_of(fit), prior)) return fit;
  fit = with_more_rim(std::move(fit), frame, prior, options, lines);
  return with_all_inside(std::move(fit), frame, prior, options, lines);
}

}  // namespace impactdic::circle
