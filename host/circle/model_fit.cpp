#include "host/circle/model_fit.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>

#include "host/circle/rim/rim_levels.h"
#include "host/circle/settings/judgement.h"
#include "host/circle/settings/levels.h"
#include "host/circle/settings/outline.h"
#include "host/circle/settings/rim_model.h"
#include "host/circle/settings/sphere.h"
#include "host/circle/sphere/sphere_lines.h"

namespace impactdic::circle {
namespace {

// A fit farther from its lines' rim is traced again: the light on a sphere is told along the lines
// from where the rim was expected.
double retrace_px(Surface surface, double step_px) {
  return step_px * (surface != Surface::kFlat ? kSphere.retrace_steps : kJudge.retrace_steps);
}

// The fit by the model lies where the crossings allow it: an edge of another shape, or a ball whose
// ink near its rim is not as it is inside, shows here.
bool agree(const Rim& rim, const RimFit& crossings, double edge_sigma_px, Surface surface) {
  // A sphere's foreshortened ink, light and limb move crossings of the half level.
  if (surface != Surface::kFlat) return distance(rim, crossings.rim) < kSphere.most_shift_px;
  const auto near = [](double off, double sd) {
    return std::abs(off) < kLearning.agree_sds * sd + kLearning.apart_px;
  };
  const Rim& other = crossings.rim;
  return near(rim.cx - other.cx, crossings.sd[0]) && near(rim.cy - other.cy, crossings.sd[1]) &&
         near(rim.r - other.r, crossings.sd[2]) &&
         std::abs(rim.r - other.r) < kLearning.most_shift * edge_sigma_px;
}

// How much likelier than a disc a sphere must be: more in even light, where a ball with little ink
// looks the same as either.
double margin(const SphereLight& light) {
  const auto at_rim = levels_at_rim(light);
  const auto [least, most] = std::minmax_element(at_rim.begin(), at_rim.end());
  return std::abs(*least / *most) > kSphere.even ? kSphere.likelier_even : kSphere.likelier;
}

class Learner {
 public:
  Learner(const Frame& frame, const RimFit& known, const RimSearch& search,
          const CirclePrior& prior, const CircleOptions& options, Surface surface, LineTrace& trace)
      : frame_(frame),
        surface_(surface),
        known_(known),
        polarity_(search.polarity),
        prior_(prior),
        options_(options),
        trace_(trace),
        first_sigma_px_(
            std::max(kLearning.sigma_of_blur * search.blur_px, kLearning.least_sigma_px)) {}

  // From a rim that is `grown_px` larger than the one that is known. Gives up where the lines are
  // far less likely than `rival`, the logarithm of how likely another model makes them.
  ModelFit run(double grown_px = 0, std::optional<double> rival = std::nullopt) {
    fit_ = {};
    fit_.rim = known_.rim;
    fit_.rim.r += grown_px;
    sigma_px_ = first_sigma_px_;
    rival_ = rival;
    if (!find_place() || !find_width()) return {};
    if (surface_ == Surface::kSphere && take_likelier_width() && !(find_place() && find_width())) {
      return {};
    }
    if (!holds()) return {};
    state_place_sd();
    return {fit_, model_, polarity_};
  }
  // Of the lines' grey levels, if they were fitted at all.
  std::optional<double> log_likelihood() const {
    if (!model_ || !fit_.ok) return std::nullopt;
    return circle::log_likelihood(trace_, *model_, from_, fit_);
  }
  // By the frame alone, whether the model holds or not; nullopt where nothing was fitted.
  std::optional<double> radius_px() const {
    return fit_.ok ? std::optional(fit_.own.r_px) : std::nullopt;
  }
  // What light and foreshortened ink make of a disc's radius is known to a share of itself.
  void doubt_correction(std::optional<double> disc_px) {
    const double usual = kSphere.radius_sd_of_r * fit_.rim.r;
    const double by_px = disc_px ? std::abs(fit_.own.r_px - *disc_px) : usual;
    const bool tells =
        disc_px && by_px < kSphere.most_shift_px && fit_.misfit < kSphere.poor_misfit;
    const double most = kSphere.most_of_usual * usual;
    const double share = is_evenly_lit(trace_) ? kSphere.of_even_correction : kSphere.of_correction;
    model_->set_light_sd_px(tells ? std::min(share * by_px, most) : usual);
  }

 private:
  RimTexture texture() const {
    RimTexture texture = texture_.result(surface_ == Surface::kFlat     ? kInk.paint_sd
                                         : surface_ == Surface::kSphere ? kSphere.paint_sd
                                                                        : kSphere.outline_sd);
    if (surface_ == Surface::kSphere) brighten(texture, paint_beside_rim(trace_, texture_));
    return texture;
  }

  TextureSums no_texture() const {
    return TextureSums(options_.evened ? kInk.least_evened : kInk.least);
  }

  // Fits under the present texture and width, from `start` if there is one.
  bool fit(const Rim* start) {
    model_ = std::make_shared<RimModel>(texture(), trace_.noise, sigma_px_, trace_.step_px);
    if (surface_ != Surface::kFlat) model_->set_surface(surface_, trace_.levels.sphere);
    fit_ = fit_lines(trace_, *model_, from_, prior_, shapes_of(options_),
                     {Thoroughness::kWithWidth, start});
    return fit_.ok;
  }

  // Traces until the fit lies on the rim that its lines were traced about; the width of the edge
  // follows.
  bool find_place() {
    for (int pass = 0; pass < kLearning.traces; ++pass) {
      from_ = fit_.rim;
      texture_ = no_texture();
      LineRequest request{polarity_, step_px_of(sigma_px_, from_.r), options_.rays};
      request.texture = &texture_;
      request.surface = surface_;
      request.edge_sigma_px = sigma_px_;
      trace_lines(frame_, from_, request, trace_);
      if (trace_.lines.empty()) return false;
      if (!fit(nullptr)) {
        const Rim start = rim_by_area(trace_, from_);  // which fine ink does not mislead
        if (!fit(&start)) return false;
      }
      if (rival_ && *log_likelihood() < *rival_ - kSphere.hopeless) return false;
      if (distance(fit_.rim, from_) < retrace_px(surface_, trace_.step_px)) break;
      sigma_px_ *= std::exp(std::clamp(fit_.width, -kLearning.most_change, kLearning.most_change));
    }
    return true;
  }

  // The root of the width that is asked for over the width that is assumed, between the nearest on
  // either side once there are both.
  bool find_width() {
    struct Side {
      double log_sigma = 0, asked = 0;
    } narrow, wide;
    constexpr double kMost = kLearning.most_asked;
    for (int pass = 0; pass < kLearning.widths; ++pass) {
      const Side here{std::log(sigma_px_), std::clamp(fit_.width, -kMost, kMost)};
      if (std::abs(here.asked) < kLearning.settled) break;
      (here.asked > 0 ? narrow : wide) = here;
      double next = here.log_sigma + kLearning.overshoot * here.asked;
      if (narrow.asked > 0 && wide.asked < 0) {
        const double way = narrow.asked / (narrow.asked - wide.asked);
        next = std::lerp(narrow.log_sigma, wide.log_sigma, way);
      }
      sigma_px_ = std::exp(next);
      const Rim last = fit_.rim;
      if (!fit(&last)) return false;
    }
    return true;
  }

  // A wider edge about a smaller ball, where it makes the lines likelier: the width that is asked
  // for has several roots where ink lies along the rim, and those of narrow edges are found first.
  // Returns whether it was taken.
  bool take_likelier_width() {
    const double narrow_px = sigma_px_;
    auto best = std::tuple(sigma_px_, fit_, model_);
    double most = *log_likelihood() + kLearning.likelier_wider;
    for (const double wider : kLearning.wider_edges) {
      sigma_px_ = wider * narrow_px;
      const Rim last = fit_.rim;
      if (!fit(&last)) break;
      if (*log_likelihood() < most) continue;
      most = *log_likelihood();
      best = {sigma_px_, fit_, model_};
    }
    std::tie(sigma_px_, fit_, model_) = best;
    return sigma_px_ != narrow_px;
  }

  bool holds() const {
    return fit_.misfit < kLearning.misfit && agree(fit_.rim, known_, sigma_px_, surface_) &&
           fit_.points > kLearning.explained * static_cast<double>(trace_.lines.size());
  }

  // How far the model may misplace the rim: what a little wider an edge does to the radius. The
  // edge of a moving ball is wider along its way, and no single width is right.
  void state_place_sd() {
    const double uneven = fit_.uneven_width;
    constexpr double kWider = kLearning.wider;
    const RimModel wider(texture(), trace_.noise, sigma_px_ * std::exp(kWider), trace_.step_px);
    const LineFit other = fit_lines(trace_, wider, from_, prior_, shapes_of(options_),
                                    {Thoroughness::kFinely, &fit_.rim});
    // By the frame alone: a radius that is known from others would hold it back.
    const double moved = other.ok ? (other.own.r_px - fit_.own.r_px) / kWider : sigma_px_;
    // Beside what hides a rim the width by chance moves little, and the rim is misplaced all the
    // same.
    const bool hidden = fit_.points < kLearning.whole_rim * trace_.in_view;
    const bool least = surface_ == Surface::kFlat && hidden;
    const double usual = std::max(std::abs(moved), least ? kLearning.least_moved_px : 0);
    const double noise = std::max(0.0, trace_.noise - kLearning.usual_noise);
    const double ink =
        std::hypot(kLearning.of_noise * noise, kLearning.of_small_px3 * std::pow(from_.r, -3));
    const double error = std::hypot(kLearning.model_error, kLearning.uneven_error * uneven, ink);
    // Ink as fine as the edge is wide, and much of it, misleads the crossings, and the model a
    // little.
    const double apart = std::abs(fit_.own.r_px - known_.rim.r) - kLearning.usual_apart_px;
    const bool told = surface_ == Surface::kFlat && !hidden && apart > 0;
    const double uncertain = std::min(fit_.own.r_sd_px / kLearning.uncertain_px, 1.0);
    const double fine = told ? kLearning.of_apart * uncertain * apart : 0;
    const double place_sd_px =
        std::hypot(std::hypot(error * usual, fine), by_hairs_px(), kLearning.least_place_sd_px);
    // From frame to frame of one ball it comes out three times as large or as small: the rms of a
    // model that is learnt anew and of the one before.
    const double before = prior_.rim_model ? prior_.rim_model->place_sd_px() : place_sd_px;
    model_->set_place_sd_px(std::hypot(place_sd_px, before) / std::numbers::sqrt2);
  }

  // What hairs on the rim, each of its own length, misplace it by.
  double by_hairs_px() const {
    const double unseen = std::clamp(1 - fit_.bare / kLearning.hardly_bare, 0.0, 1.0);
    const double alike =
        std::clamp((fit_.wider - kLearning.alike_from) / kLearning.alike_over, 0.0, 1.0);
    return kLearning.of_hairs * unseen * alike * std::abs(fit_.own.r_px - known_.rim.r);
  }

  const Frame& frame_;
  const Surface surface_;
  const RimFit& known_;
  const Polarity polarity_;
  const CirclePrior& prior_;
  const CircleOptions& options_;
  LineTrace& trace_;
  const double first_sigma_px_;
  double sigma_px_ = 1;  // of the edge
  std::optional<double> rival_;
  Rim from_;  // that the lines were traced about
  TextureSums texture_ = no_texture();
  std::shared_ptr<RimModel> model_;
  LineFit fit_;
};

}  // namespace

double distance(const Rim& a, const Rim& b) {
  return std::hypot(a.cx - b.cx, a.cy - b.cy) + std::abs(a.r - b.r) +
         std::hypot(a.e1 - b.e1, a.e2 - b.e2);
}

ModelFit follow_rim(const Frame& frame, const CirclePrior& prior, const CircleOptions& options,
                    Approach approach, LineTrace& trace) {
  const RimModel& model = *prior.rim_model;
  const bool preview_first = approach == Approach::kAfterPreview;
  const double farthest = preview_first ? kJudge.followed_steps : kJudge.retrace_steps;
  LineFit fit;
  fit.rim = rim_of(prior);
  for (int pass = 0; pass < kJudge.follow_traces; ++pass) {
    const bool preview = preview_first && pass == 0;
    const Rim from = fit.rim;
    LineRequest request{polarity_of(*prior.bright), model.step_px(),
                        preview ? options.rays / kJudge.preview_of_lines : options.rays};
    if (pass > 0) request.levels = LineRequest::Levels::kAsBefore;
    request.surface = model.surface();
    request.edge_sigma_px = model.edge_sigma_px();
    request.light = model.light();
    trace_lines(frame, from, request, trace);
    if (trace.noise > kJudge.noisier * model.noise()) break;
    if (trace.in_view < kJudge.in_view * trace.cast) break;
    LineStart start{Thoroughness::kPreview};
    const KindShares shares = fit.shares;
    if (!preview) start = {Thoroughness::kFinely, &from, pass > 0 ? &shares : nullptr};
    fit = fit_lines(trace, model, from, prior, shapes_of(options), start);
    if (!fit.ok) break;
    if (fit.points < kJudge.followable * static_cast<double>(trace.lines.size())) break;
    const double moved = distance(fit.rim, from) / trace.step_px;
    if (moved > farthest) break;
    if (!preview && moved * trace.step_px < retrace_px(model.surface(), trace.step_px))
      return {fit, prior.rim_model, polarity_of(*prior.bright)};
  }
  return {};
}

ModelFit learn_rim(const Frame& frame, const RimFit& known, const RimSearch& search,
                   const CirclePrior& prior, const CircleOptions& options, LineTrace& trace) {
  Learner as_disc(frame, known, search, prior, options, Surface::kFlat, trace);
  const ModelFit disc = as_disc.run();
  const bool known_disc = options.sphere == false;
  if (known_disc && disc.fit.ok) return disc;
  const auto of_disc = as_disc.log_likelihood();
  thread_local LineTrace other;  // memory only
  Learner as_sphere(frame, known, search, prior, options, Surface::kSphere, other);
  ModelFit sphere;
  for (const double grown_px : kSphere.grown_px) {
    if (known_disc || sphere.fit.ok) break;
    sphere = as_sphere.run(grown_px, of_disc);
  }
  const auto above = [&] {
    return options.sphere.value_or(false) ? kSphere.likelier_known : margin(other.levels.sphere);
  };
  const bool is_sphere =
      sphere.fit.ok && !(of_disc && *as_sphere.log_likelihood() < *of_disc + above());
  if (!is_sphere && disc.fit.ok) return disc;
  if (!is_sphere) sphere = {};
  if (is_sphere) as_sphere.doubt_correction(as_disc.radius_px());
  // The light of an outline is found from more of the ball.
  const Rim& rim = is_sphere ? sphere.fit.rim : known.rim;
  LineRequest request{search.polarity, step_px_of(search.blur_px, rim.r), options.rays};
  request.surface = Surface::kOutline;
  trace_lines(frame, rim, request, trace);
  if (trace.lines.empty() || !fades(trace.levels)) {
    if (is_sphere) std::swap(trace, other);
    return sphere;
  }
  RimSearch either = search;
  for (const Polarity polarity : {Polarity::kBright, Polarity::kDark}) {
    either.polarity = polarity;
    Learner as_outline(frame, known, either, prior, options, Surface::kOutline, trace);
    for (const double grown_px : kSphere.grown_px) {
      const ModelFit outline = as_outline.run(grown_px);
      if (!outline.fit.ok) continue;
      as_outline.doubt_correction(std::nullopt);
      return outline;
    }
  }
  if (!is_sphere) return {};
  std::swap(trace, other);
  return sphere;
}

}  // namespace impactdic::circle
