#include "host/circle/describe_fit.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "host/circle/rays/frame_level.h"
#include "host/circle/rim/rim_levels.h"
#include "host/circle/settings/rim_model.h"
#include "host/circle/settings/sphere.h"
#include "host/circle/sphere/disc_doubt.h"
#include "host/circle/sphere/sphere_lines.h"

namespace impactdic::circle {
namespace {

// Between neighbours, rad. Ink on the rim makes gaps too: those are narrow, and count for none.
// Points in the order of the angle; all around where there is none.
double widest_gap(const std::vector<float>& cos, const std::vector<float>& sin,
                  std::size_t points) {
  const float narrow = static_cast<float>(std::cos(kJudge.gap_deg * kRadPerDeg));
  double widest = 0;
  for (std::size_t a = 0; a < points; ++a) {
    const std::size_t b = a + 1 < points ? a + 1 : 0;
    const float along = cos[a] * cos[b] + sin[a] * sin[b];
    if (along > narrow) continue;
    const double gap = std::atan2(cos[a] * sin[b] - sin[a] * cos[b], along);
    widest = std::max(widest, gap < 0 ? gap + 2 * kPi : gap);
  }
  return points == 0 ? 2 * kPi : widest;
}

// See Circle::free_px.
double free_distance(double gap_rad, const Rim& rim) {
  return rim.r * std::max(0.0, std::cos(gap_rad / 2));
}

// What both kinds of fit have. A blurred disc crosses its half level inside its rim: at R − σ²/2R
// (mean of the Rice distribution).
template <typename Fit>
void fill_from(const Fit& fit, double edge_sigma_px, double radius_bias_sd_px, CircleFit& result) {
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

// Grey level of the paint of a bright ball, or of what lies behind a dark one.
double brightest(const LineTrace::Levels& levels, Surface surface, bool bright) {
  if (!bright) return -*std::min_element(levels.ground.begin(), levels.ground.end());
  return surface != Surface::kFlat ? levels.sphere.at(0, 0, 1)
                                   : static_cast<double>(levels.light[0]);
}

// Where just inside of the rim the camera's scale ends: the first harmonic along x and y, 1 the
// share of all directions.
struct CutOff {
  double x = 0, y = 0;
};
CutOff cut_off(const Frame& frame, const Circle& circle) {
  constexpr int kPlaces = 48, kDeepest_px = 8;  // ink hides some of the depths
  CutOff cut;
  for (int k = 0; k < kPlaces; ++k) {
    const double c = std::cos(2 * kPi * k / kPlaces), s = std::sin(2 * kPi * k / kPlaces);
    bool at_end = false;
    for (int depth = 2; depth <= kDeepest_px && !at_end; depth += 2) {
      const long x = std::lround(circle.cx_px + (circle.r_px - depth) * c);
      const long y = std::lround(circle.cy_px + (circle.r_px - depth) * s);
      at_end = x >= 0 && y >= 0 && x < frame.width() && y < frame.height() &&
               level_at(frame, static_cast<int>(x), static_cast<int>(y)) >= frame.full_scale();
    }
    if (at_end) cut.x += c * 2 / kPlaces, cut.y += s * 2 / kPlaces;
  }
  return cut;
}

// Of a ball whose bright side alone is cut off, the rim moves outwards there, and with it the
// centre.
void doubt_over_exposed(const Frame& frame, double edge_sigma_px, double brightest,
                        CircleFit& fit) {
  const double by_px = kJudge.over_exposed_sd * edge_sigma_px;
  bool over_exposed = is_over_exposed(brightest, frame);
  const bool nearly = brightest > kJudge.nearly_over_exposed * frame.full_scale();
  const CutOff cut = nearly ? cut_off(frame, fit.circle) : CutOff{};
  if (std::hypot(cut.x, cut.y) > kJudge.cut_off_aside) {
    over_exposed = true;
    fit.cx_sd_px = std::hypot(fit.cx_sd_px, by_px * cut.x);
    fit.cy_sd_px = std::hypot(fit.cy_sd_px, by_px * cut.y);
  }
  if (over_exposed) fit.r_sd_px = std::hypot(fit.r_sd_px, by_px);
}

// How much more than all of the rim noise misplaces single arcs, and with them centre and shape:
// the paint's level and the ink that is learnt beside it err from place to place. A sphere's
// foreshortened ink misplaces its rim alike all around.
double of_arcs(const RimModel& model, const LineTrace& trace) {
  if (model.surface() != Surface::kFlat) return is_plainly_lit(trace) ? kSphere.even_arcs : 1;
  const double ink = kLearning.of_noise * std::max(0.0, model.noise() - kLearning.usual_noise);
  return std::hypot(kLearning.model_error, kLearning.noise_in_arcs * ink) /
         std::hypot(kLearning.model_error, ink);
}

}  // namespace

bool is_over_exposed(double brightest, const Frame& frame) {
  return brightest > kJudge.over_exposed * frame.full_scale();
}

void fill(const RimFit& fit, double edge_sigma_px, double radius_bias_sd_px, CircleFit& result) {
  fill_from(fit, edge_sigma_px, radius_bias_sd_px, result);
}

double free_distance(const RimTrace& trace, const Rim& rim) {
  std::vector<float> cos, sin;
  for (const RimPoint& p : trace.points) {
    if (std::abs(p.excess) > kJudge.on_rim_px) continue;
    cos.push_back(p.cos);
    sin.push_back(p.sin);
  }
  return free_distance(widest_gap(cos, sin, cos.size()), rim);
}

CircleFit describe(const Frame& frame, const ModelFit& m, const LineTrace& trace,
                   const CirclePrior& prior, bool bright) {
  const RimLines& lines = trace.lines;
  return describe(frame, m, trace, widest_gap(lines.cos, lines.sin, lines.size()), prior, bright);
}

CircleFit describe(const Frame& frame, const ModelFit& m, const LineTrace& trace, double gap_rad,
                   const CirclePrior& prior, bool bright) {
  CircleFit result;
  const double sigma = m.rim_model->edge_sigma_px();
  LineFit fit = m.fit;
  const double place = m.rim_model->place_sd_px(), arcs = place * of_arcs(*m.rim_model, trace);
  const auto of_model = [&](int i) {
    return (i == 2 ? place : arcs) * std::sqrt(fit.misplaced[i]);
  };
  for (int i = 0; i < 5; ++i) fit.sd[i] = std::hypot(fit.sd[i], of_model(i));
  fit.own.r_sd_px = std::hypot(fit.own.r_sd_px, place * std::sqrt(fit.own.misplaced));
  fill_from(fit, sigma, prior.radius_bias_sd_px, result);
  result.shared_r_sd_px = std::hypot(of_model(2), fit.own.follows[2] * prior.radius_bias_sd_px);
  const bool arc = fit.points < kSphere.most_left * trace.in_view;
  if (m.rim_model->surface() != Surface::kFlat) {
    // Ink misplaces the rim alike all around; light does not, and bends it. What is darker than the
    // background may be the dark side of a ball.
    const bool even = bright && is_evenly_lit(trace);
    for (double* with_r : {&result.cx_with_r, &result.cy_with_r}) {
      *with_r *= even ? 0 : kSphere.bent_with_radius;
    }
    if (!even) widen(result, kSphere.lit_centre_sd_of_r * result.circle.r_px, 0);
    // What light and foreshortened ink do to a rim that is pressed is not alike all around.
    if (result.ellipse) widen(result, kSphere.pressed_of_light * m.rim_model->light_sd_px(), 0);
    const double usual = arc ? kSphere.radius_sd_of_r * result.circle.r_px : 0;
    widen(result, 0, std::max(m.rim_model->light_sd_px(), usual));
  } else if (arc) {
    const double per_r2 = 1 / (result.circle.r_px * result.circle.r_px);
    widen(result, kLearning.arc_centre_px3 * per_r2, kLearning.arc_radius_px3 * per_r2);
  }
  // What is left of a rim that fades is an arc: a light that is a little wrong moves its centre.
  if (m.rim_model->surface() == Surface::kSphere && fades(trace.levels) && arc) {
    result.cx_sd_px = std::hypot(result.cx_sd_px, kSphere.arc_sd_px);
    result.cy_sd_px = std::hypot(result.cy_sd_px, kSphere.arc_sd_px);
    result.r_sd_px = std::hypot(result.r_sd_px, kSphere.arc_sd_px);
  }
  if (m.rim_model->surface() == Surface::kOutline) {
    const double r = result.circle.r_px, arc_px = arc ? kSphere.outline_arc_px3 / (r * r) : 0;
    widen(result, kSphere.outline_centre_px2 / r, kSphere.outline_radius_px2 / r);
    widen(result, arc_px, arc_px);
  }
  doubt_over_exposed(frame, sigma, brightest(trace.levels, m.rim_model->surface(), bright), result);
  // What lies just outside the rim is guessed from what lies beside it.
  const double texture = std::min(1.0, trace.breaks / (1.0 + kJudge.texture_breaks));
  widen(result, texture * kJudge.texture_px, texture * kJudge.texture_radius_px);
  // Ink is mixed into a rim by how much it differs from what lies behind, which differs there.
  const GroundRise rise = rise_of_ground(trace.levels.ground, trace.levels.usual, middle_of_lines);
  const double by_ink_px = kJudge.of_rise * std::hypot(place, m.rim_model->light_sd_px());
  result.cx_sd_px = std::hypot(result.cx_sd_px, rise.x * by_ink_px);
  result.cy_sd_px = std::hypot(result.cy_sd_px, rise.y * by_ink_px);
  result.circle.free_px = free_distance(gap_rad, m.fit.rim);
  result.bright = bright;
  result.rim_model = m.rim_model;
  result.rim_fraction = static_cast<double>(m.fit.points) / trace.cast;
  return result;
}

CircleFit accepted(CircleFit fit, const Frame& frame, const CircleOptions& options) {
  const Circle& c = fit.circle;
  // Of a speck, or of a straight edge.
  if (!(c.r_px > 1 && c.r_px < frame.width() + frame.height())) {
    return CircleFit{.bright = fit.bright};
  }
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

}  // namespace impactdic::circle
