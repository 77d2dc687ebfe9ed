#include "host/circle/scout_backdrop.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "host/base/parallel/parallel_for.h"
#include "host/base/statistics.h"
#include "host/circle/rim/rim_model.h"
#include "host/circle/settings/backdrop.h"
#include "host/circle/settings/search.h"

namespace impactdic::circle {
namespace {

using View = Backdrop::View;

// The views in which a ball is seen.
std::vector<View> showing_balls(const std::vector<View>& views) {
  std::vector<View> showing;
  std::copy_if(views.begin(), views.end(), std::back_inserter(showing),
               [](const View& view) { return !view.balls.empty(); });
  return showing;
}

CirclePrior prior_at(const Backdrop::Outline& ball, double centre_sd_px = kScout.found_sd_px) {
  CirclePrior prior;
  prior.predicted = ball.circle;
  prior.e1_px = ball.e1_px;
  prior.e2_px = ball.e2_px;
  prior.centre_sd_px = centre_sd_px;
  return prior;
}

// Whether the views show discs: their rims show all around, and a texture behind them does less
// harm than what is left where it was taken away.
bool are_discs(const std::vector<View>& views, const CircleOptions& options) {
  if (options.sphere) return !*options.sphere;
  std::vector<char> flat(views.size(), 0);
  parallel_for(views.size(), [&](std::size_t k) {
    const CircleFit fit =
        measure_circle(*views[k].frame, prior_at(views[k].balls.front()), options);
    flat[k] = fit.rim_model && fit.rim_model->surface() == Surface::kFlat;
  });
  return 2 * std::count(flat.begin(), flat.end(), 1) > std::ssize(flat);
}

void measure_again(const Backdrop& backdrop, const CircleOptions& options, bool with_model,
                   View& view) {
  for (Backdrop::Outline& ball : view.balls) {
    CirclePrior prior = prior_at(ball);
    prior.learn = with_model;
    const CircleFit fit = measure_circle(*view.frame, prior, options, &backdrop);
    if (fit.status == CircleStatus::kOk) ball = {fit.circle, fit.e1_px, fit.e2_px};
  }
}

// A radius, known to so much of itself.
struct AboutRadius {
  double px = 0, within = 0;
};

void look_for_ball(const Backdrop& backdrop, const AboutRadius& radius, CircleOptions options,
                   View& view) {
  options.radius_range_px = {(1 - radius.within) * radius.px, (1 + radius.within) * radius.px};
  options.evened = true;
  Frame evened;
  backdrop.even(*view.frame, evened);
  if (const auto found = find_ball(evened, options)) view.balls.push_back({*found});
}

// What is roughly known of the background shows the balls better, and they show the background.
std::shared_ptr<const Backdrop> learn_better(std::shared_ptr<const Backdrop> known,
                                             const AboutRadius& radius,
                                             const CircleOptions& options,
                                             std::vector<View>& views) {
  for (int round = 0; known && round < kBackdrop.learnings; ++round) {
    parallel_for(views.size(), [&](std::size_t k) {
      if (views[k].balls.empty()) look_for_ball(*known, radius, options, views[k]);
      measure_again(*known, options, round > 0, views[k]);
    });
    known = Backdrop::learn(showing_balls(views), Backdrop::Known::kWell);
  }
  return known;
}

// That of most discs that moved; the others are taken out of the views. nullopt of too few.
std::optional<AboutRadius> agreed_radius(std::vector<View>& views) {
  std::vector<double> radii_px;
  for (const View& view : showing_balls(views)) radii_px.push_back(view.balls.front().circle.r_px);
  if (radii_px.empty()) return std::nullopt;
  const AboutRadius radius{upper_median(std::move(radii_px)), kBackdrop.moved_within};
  for (View& view : views) {
    std::erase_if(view.balls, [&](const Backdrop::Outline& disc) {
      return std::abs(disc.circle.r_px - radius.px) > radius.within * radius.px;
    });
  }
  const bool few = showing_balls(views).size() < kBackdrop.least_views;
  if (few || radius.px < kBallSearch.least_r_px) return std::nullopt;
  return radius;
}

// The ball about the disc that moved, before what is roughly known of the background; none where
// no rim shows there.
void look_about(const Backdrop& backdrop, const CircleOptions& options, View& view) {
  if (view.balls.empty()) return;
  const Circle disc = view.balls.front().circle;
  CirclePrior prior = prior_at({disc}, kBackdrop.moved_sd * disc.r_px);
  prior.rim_sd_px = prior.centre_sd_px;
  prior.learn = false;
  const CircleFit fit = measure_circle(*view.frame, prior, options, &backdrop);
  view.balls.clear();
  if (fit.status == CircleStatus::kOk) view.balls.push_back({fit.circle, fit.e1_px, fit.e2_px});
}

// The ball of a view before what lies behind it, where it is plainly one: before an evened
// background whatever comes is plain, arms have round ends, too. Where the ball is as the wall is,
// less of a rim will do about the disc that moved.
std::optional<FoundBall> plain_ball(const Backdrop* backdrop, const CircleOptions& options,
                                    const View& view, const std::optional<Circle>& moved) {
  if (view.balls.empty()) return std::nullopt;
  const CircleFit fit =
      measure_circle(*view.frame, prior_at(view.balls.front()), options, backdrop);
  const bool as_moved =
      moved &&
      std::max(std::hypot(fit.circle.cx_px - moved->cx_px, fit.circle.cy_px - moved->cy_px),
               std::abs(fit.circle.r_px - moved->r_px)) < kBackdrop.as_moved * moved->r_px;
  const double least_rim = as_moved ? kBackdrop.as_moved_rim : kBackdrop.plain_rim;
  const bool plain = fit.status == CircleStatus::kOk && fit.rim_fraction >= least_rim &&
                     std::hypot(fit.e1_px, fit.e2_px) <= kBackdrop.plain_oval * fit.circle.r_px;
  if (!plain) return std::nullopt;
  return FoundBall{fit.circle, fit.rim_fraction, fit.rim_fraction * fit.circle.r_px, fit.bright,
                   fit.residual_px};
}

// What was learnt from the views, if anything, and which of their balls are plain before it.
// `moved`: the discs that moved, view by view, where they are known.
ScoutedBackdrop judged(std::shared_ptr<const Backdrop> known, const CircleOptions& options,
                       const std::vector<View>& views,
                       const std::vector<std::optional<Circle>>& moved) {
  ScoutedBackdrop scouted{std::move(known), {}};
  scouted.plain.resize(views.size());
  parallel_for(views.size(), [&](std::size_t k) {
    scouted.plain[k] = plain_ball(scouted.backdrop.get(), options, views[k], moved[k]);
  });
  return scouted;
}

// By discs so much larger than what moved, share of their radius.
ScoutedBackdrop scout_within(double beyond, const AboutRadius& radius, const CircleOptions& options,
                             std::vector<View> views) {
  std::vector<View> holding = showing_balls(views);
  for (View& view : holding) view.balls.front().circle.r_px *= 1 + beyond;
  const auto roughly = Backdrop::learn(holding, Backdrop::Known::kWithin);
  if (!roughly) return {};
  std::vector<std::optional<Circle>> moved(views.size());
  parallel_for(views.size(), [&](std::size_t k) {
    if (!views[k].balls.empty()) moved[k] = views[k].balls.front().circle;
    look_about(*roughly, options, views[k]);
  });
  auto known = learn_better(roughly, radius, options, views);
  if (!known) return {};
  return judged(std::move(known), options, views, moved);
}

}  // namespace

double ScoutedBackdrop::shown() const {
  double sum = 0;
  for (const auto& ball : plain) sum += ball ? ball->rim_fraction : 0;
  return sum;
}

ScoutedBackdrop scout_backdrop(std::vector<View> views, double radius_px,
                               const CircleOptions& options) {
  std::shared_ptr<const Backdrop> known =
      Backdrop::learn(showing_balls(views), Backdrop::Known::kRoughly);
  if (!known || are_discs(showing_balls(views), options)) return {};
  known = learn_better(known, {radius_px, kScout.same_radius}, options, views);
  if (!known) return {};
  return judged(std::move(known), options, views, std::vector<std::optional<Circle>>(views.size()));
}

ScoutedBackdrop scout_without_backdrop(const std::vector<View>& views,
                                       const CircleOptions& options) {
  return judged(nullptr, options, views, std::vector<std::optional<Circle>>(views.size()));
}

ScoutedBackdrop scout_moved_backdrop(std::vector<View> views, const CircleOptions& options) {
  const std::optional<AboutRadius> radius = agreed_radius(views);
  ScoutedBackdrop best;
  if (!radius) return best;
  for (const double beyond : kBackdrop.moved_beyond) {
    ScoutedBackdrop scouted = scout_within(beyond, *radius, options, views);
    if (scouted.shown() > best.shown()) best = std::move(scouted);
  }
  return best;
}

}  // namespace impactdic::circle
