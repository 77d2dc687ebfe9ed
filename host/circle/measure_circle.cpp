// From a frame and what is known of it to a measured circle: search, trace, fit.
#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "host/circle/circle.h"
#include "host/circle/rim/rim.h"
#include "host/circle/rim/rim_lines.h"
#include "host/circle/rim/rim_model.h"

namespace impactdic::circle {
namespace {

constexpr double kRimInView = 0.35;  // less of the rim than this in the picture: out of view
constexpr double kLeastArc = 0.12;   // share of the rim's sectors that must hold points
constexpr int kLeastPoints = 24;
constexpr double kDense = 0.6;    // share of inked points above which a sharp kernel is better
constexpr double kRetrace = 0.1;  // px; a fit farther from its rays' rim is traced again
constexpr double kOnRim_px = 3;   // points so near show the rim
// Of the fit by the look; steps are those of the lines.
constexpr double kSharpest_px = 0.75;    // a wider edge is sampled on proportionally wider steps
constexpr double kRetraceLines = 0.2;    // steps; a fit farther from its lines' rim is traced again
constexpr double kFollowed = 1.5;        // steps; a rim farther from its prediction is searched
constexpr int kFew = 3;                  // of so many lines one is enough for a first look
constexpr double kWidthSettled = 0.01;   // of ln σ
constexpr int kTraces = 6, kWidths = 5;  // at most
constexpr double kClose = 0.8;           // steps that a prediction may scatter to be followed
constexpr double kNear = 0.15;           // and to be taken as it is
constexpr double kFollowedOval = 0.01;   // e/R of a prediction, no more
constexpr double kLeastSearch_px = 0.3;  // scatter of a prediction that has to be searched about
constexpr double kNoisier = 2;           // than when the look was learnt: learn again
constexpr double kExplained = 0.7;       // share of the lines that must have to do with the rim
constexpr double kFollowable = 0.9;      // and must where no search confirms the rim
constexpr double kMisfit = 20;           // RimModel::misfit; 7 where the model holds
constexpr double kApart_px = 0.015;      // of the two kinds of fit, and
constexpr double kMostShift = 0.4;       // of the edge's σ: what ink may shift the crossings
// The ball is foreshortened towards its rim, so that its ink there is finer than where the look is
// learnt. That misplaces the rim about as a misjudged width of the edge would, by so much of ln σ.
constexpr double kLookError = 0.06;
constexpr double kLeastPlaceSd_px = 0.001;
constexpr double kWider = 0.05;  // of ln σ, to see what the width does

double distance(const Rim& a, const Rim& b) {
  return std::hypot(a.cx - b.cx, a.cy - b.cy) + std::abs(a.r - b.r) +
         std::hypot(a.e1 - b.e1, a.e2 - b.e2);
}

// See Circle::free_px. Ink on the rim makes gaps too: those are narrow. Points in the order of the
// angle.
double free_distance(const std::vector<float>& cos, const std::vector<float>& sin,
                     std::size_t points, const Rim& rim) {
  const float narrow = static_cast<float>(std::cos(20 * kRadPerDeg));
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
void fill(const Fit& fit, double edge_sigma_px, CircleFit& result) {
  const double shrink = edge_sigma_px * edge_sigma_px / (2 * fit.rim.r);
  result.circle = {fit.rim.cx, fit.rim.cy, fit.rim.r + shrink};
  result.cx_sd_px = fit.sd[0];
  result.cy_sd_px = fit.sd[1];
  result.r_sd_px = fit.sd[2];
  result.ellipse = fit.ellipse;
  result.e1_px = fit.rim.e1;
  result.e2_px = fit.rim.e2;
  result.e1_sd_px = fit.sd[3];
  result.e2_sd_px = fit.sd[4];
  result.residual_px = fit.residual_px;
  result.rim_points = fit.points;
}

double step_of(double sigma_px, const Rim& rim) {
  return std::clamp(sigma_px / kSharpest_px, 1.0, rim.r / 8);
}

// A rim by its look.
struct ByLook {
  LineFit fit;
  std::shared_ptr<const RimModel> look;
};

// With the prior's look, from a rim known to a pixel, or where no rough fit is made first to a
// small part of one. Not ok where that does not hold.
ByLook follow(const Frame& frame, const CirclePrior& prior, const CircleOptions& options,
              bool rough_first, LineTrace& trace) {
  ByLook m{{}, prior.look};
  const Circle& c = prior.predicted;
  m.fit.rim = {c.cx_px, c.cy_px, c.r_px, prior.e1_px, prior.e2_px};
  for (int pass = 0; pass < 3; ++pass) {
    const bool roughly = rough_first && pass == 0;
    const Rim from = m.fit.rim;
    trace_lines(frame, from, *prior.bright, m.look->step_px(),
                roughly ? options.rays / kFew : options.rays, {.levels = pass == 0}, trace);
    if (trace.noise > kNoisier * m.look->noise() || trace.in_view < kRimInView * trace.cast) break;
    LineStart start{Thoroughness::roughly};
    const KindShares shares = m.fit.shares;
    if (!roughly) start = {Thoroughness::finely, &from, pass > 0 ? &shares : nullptr};
    m.fit = fit_lines(trace, *m.look, from, prior, options.allow_ellipse, start);
    if (!m.fit.ok || m.fit.points < kFollowable * static_cast<double>(trace.lines.size())) break;
    const double moved = distance(m.fit.rim, from) / trace.step_px;
    if (moved > (rough_first ? kFollowed : kRetraceLines)) break;
    if (!roughly && moved < kRetraceLines) return m;
  }
  return {};
}

// The fit by the look lies where the crossings allow it: an edge of another shape, or a ball that
// looks otherwise near its rim, shows here.
bool agree(const Rim& rim, const RimFit& crossings, double edge_sigma_px) {
  const auto near = [](double off, double sd) { return std::abs(off) < 5 * sd + kApart_px; };
  const Rim& other = crossings.rim;
  return near(rim.cx - other.cx, crossings.sd[0]) && near(rim.cy - other.cy, crossings.sd[1]) &&
         near(rim.r - other.r, crossings.sd[2]) &&
         std::abs(rim.r - other.r) < kMostShift * edge_sigma_px;
}

// Learns the look from a rim that is known already, and fits again. Not ok where the lines do not
// follow the model.
ByLook learn(const Frame& frame, const RimFit& known, bool bright, double blur_px,
             const CirclePrior& prior, const CircleOptions& options, LineTrace& trace) {
  ByLook m;
  m.fit.rim = known.rim;
  Rim from;
  TextureSums texture;
  double sigma = std::max(0.8 * blur_px, 0.6);
  std::shared_ptr<RimModel> look;
  const auto fit = [&](const Rim* start) {
    look = std::make_shared<RimModel>(texture.result(), trace.noise, sigma, trace.step_px);
    m.look = look;
    m.fit = fit_lines(trace, *look, from, prior, options.allow_ellipse,
                      {Thoroughness::with_width, start});
    return m.fit.ok;
  };
  for (int pass = 0; pass < kTraces; ++pass) {
    from = m.fit.rim;
    texture = {};
    trace_lines(frame, from, bright, step_of(sigma, from), options.rays, {.texture = &texture},
                trace);
    if (trace.lines.empty()) return {};
    if (!fit(nullptr)) {
      const Rim start = rim_by_area(trace, from);  // which fine ink does not mislead
      if (!fit(&start)) return {};
    }
    if (distance(m.fit.rim, from) < kRetraceLines * trace.step_px) break;
    sigma *= std::exp(std::clamp(m.fit.width, -0.3, 0.3));
  }
  // The root of the width that is asked for over the width that is assumed, between the nearest
  // on either side once there are both.
  struct Side {
    double log_sigma = 0, asked = 0;
  } narrow, wide;
  for (int pass = 0; pass < kWidths; ++pass) {
    const Side here{std::log(sigma), std::clamp(m.fit.width, -0.2, 0.2)};
    if (std::abs(here.asked) < kWidthSettled) break;
    (here.asked > 0 ? narrow : wide) = here;
    double next = here.log_sigma + 1.5 * here.asked;
    if (narrow.asked > 0 && wide.asked < 0) {
      next =
          std::lerp(narrow.log_sigma, wide.log_sigma, narrow.asked / (narrow.asked - wide.asked));
    }
    sigma = std::exp(next);
    const Rim last = m.fit.rim;
    if (!fit(&last)) return {};
  }
  const bool holds = m.fit.misfit < kMisfit && agree(m.fit.rim, known, sigma) &&
                     m.fit.points > kExplained * static_cast<double>(trace.lines.size());
  if (!holds) return {};
  const RimModel wider(texture.result(), trace.noise, sigma * std::exp(kWider), trace.step_px);
  const LineFit other = fit_lines(trace, wider, from, prior, options.allow_ellipse,
                                  {Thoroughness::finely, &m.fit.rim});
  const double moved = other.ok ? (other.rim.r - m.fit.rim.r) / kWider : sigma;
  look->set_place_sd_px(std::hypot(kLookError * moved, kLeastPlaceSd_px));
  return m;
}

CircleFit describe(const ByLook& m, const LineTrace& trace, bool bright) {
  CircleFit result;
  const double sigma = m.look->edge_sigma_px();
  LineFit fit = m.fit;
  for (int i = 0; i < 5; ++i) {
    fit.sd[i] = std::hypot(fit.sd[i], m.look->place_sd_px() * std::sqrt(fit.misplaced[i]));
  }
  fill(fit, sigma, result);
  result.circle.free_px =
      free_distance(trace.lines.cos, trace.lines.sin, trace.lines.size(), m.fit.rim);
  result.bright = bright;
  result.look = m.look;
  result.rim_fraction = static_cast<double>(m.fit.points) / trace.cast;
  return result;
}

}  // namespace

const char* to_string(CircleStatus status) {
  switch (status) {
    case CircleStatus::ok:
      return "ok";
    case CircleStatus::no_ball:
      return "no_ball";
    case CircleStatus::out_of_view:
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
  const auto accepted = [&](CircleFit result) {
    const Circle& c = result.circle;
    if (options.radius_range_px &&
        (c.r_px < options.radius_range_px->first || c.r_px > options.radius_range_px->second)) {
      return CircleFit{.bright = result.bright};
    }
    const bool centre_in = c.cx_px >= 0 && c.cy_px >= 0 && c.cx_px <= frame.width() - 1 &&
                           c.cy_px <= frame.height() - 1;
    result.status = centre_in ? CircleStatus::ok : CircleStatus::out_of_view;
    return result;
  };
  const auto enough = [](const auto& fit) {
    return fit.ok && fit.points >= kLeastPoints && fit.arc >= kLeastArc;
  };

  thread_local LineTrace lines;  // memory only
  // A ball under strong compression changes its shape from frame to frame: it is searched.
  const bool steady = std::hypot(prior.e1_px, prior.e2_px) < kFollowedOval * prior.predicted.r_px;
  if (steady && prior.look && prior.bright && prior.rim_sd_px &&
      std::hypot(prior.centre_sd_px, *prior.rim_sd_px) < kClose * prior.look->step_px()) {
    const bool near = prior.centre_sd_px < kNear * prior.look->step_px();
    ByLook m;
    if (near) m = follow(frame, prior, options, false, lines);
    if (!enough(m.fit)) m = follow(frame, prior, options, true, lines);
    if (enough(m.fit)) return accepted(describe(m, lines, *prior.bright));
  }

  CircleFit result;
  CirclePrior around = prior;
  around.centre_sd_px = std::max(prior.centre_sd_px, kLeastSearch_px);
  const RimSearch search = search_rim(frame, around, options);
  result.bright = search.bright;
  if (search.in_view < kRimInView) {
    result.status = CircleStatus::out_of_view;
    return result;
  }
  if (!search.found) return result;

  thread_local RimTrace trace;  // memory only
  RimFit fit;
  fit.rim = search.rim;
  // Ink leaves the search too far off for a single trace: then the first one is a coarse one.
  bool sharp = prior.inked, coarse = prior.inked;
  int rays = options.rays;
  for (int pass = 0; pass < 4; ++pass) {
    const Rim rim = fit.rim;
    rays = coarse ? std::max(options.rays / 3, 64) : options.rays;
    trace_rim(frame, rim, search.bright, search.blur_px, sharp, rays, trace);
    fit = fit_rim(trace, rim, prior, options.allow_ellipse);
    if (!fit.ok) break;
    if (std::exchange(coarse, false)) continue;
    const bool sharpen = !sharp && fit.inked > kDense;
    if (!sharpen && distance(fit.rim, rim) < kRetrace) break;
    sharp |= sharpen;
  }
  if (trace.rays_in_view < kRimInView * rays) {
    result.status = CircleStatus::out_of_view;
    return result;
  }
  if (!enough(fit)) return result;
  std::vector<float> cos, sin;
  for (const RimPoint& p : trace.points) {
    if (std::abs(p.excess) > kOnRim_px) continue;
    cos.push_back(p.cos);
    sin.push_back(p.sin);
  }
  const double free_px = free_distance(cos, sin, cos.size(), fit.rim);
  if (prior.learn) {
    const ByLook m = learn(frame, fit, search.bright, search.blur_px, prior, options, lines);
    if (enough(m.fit)) {
      CircleFit by_look = describe(m, lines, search.bright);
      by_look.inked = fit.inked > kDense;
      by_look.circle.free_px = free_px;  // crossings end more sharply at what hides the rim
      return accepted(by_look);
    }
  }
  fill(fit, trace.edge_sigma_px, result);
  result.circle.free_px = free_px;
  result.inked = fit.inked > kDense;
  result.rim_fraction = static_cast<double>(fit.points) / options.rays;
  return accepted(result);
}

}  // namespace impactdic::circle
