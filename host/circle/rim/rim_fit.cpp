// Circle or ellipse through the traced edges: iteratively re-weighted least squares with Tukey's
// biweight (Holland and Welsch, 1977), about a rim so close that the geometric distance is linear
// in its corrections: excess = x cos φ + y sin φ + dR + de1 cos 2φ + de2 sin 2φ, with an error of
// x²/2R (4e-5 px at x = 0.1 px and R = 115 px; measure_circle traces again from farther away).
#include <impactdic/units.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "host/base/statistics.h"
#include "host/circle/rays/crossing_density.h"
#include "host/circle/rim/rim.h"
#include "host/circle/rim/rim_prior.h"
#include "host/circle/settings/crossings.h"
#include "host/circle/settings/line_fit.h"

namespace impactdic::circle {
namespace {

// One fit: corrections to the rim, their covariance, and what the residuals say.
struct RimEstimate {
  bool ok = false;
  Vector5 delta = Vector5::Zero();
  Matrix5 covariance = Matrix5::Zero();
  double with_radius[2] = {};  // as RimFit's
  RadiusOfFrame own;
  double scale = 0;  // scatter of the clean points
  int points = 0;
  double arc = 0;
  double oval = 0;  // of a circle: χ² that its residuals hold against it, 2 degrees of freedom
};

struct Sums {
  Matrix5 curvature = Matrix5::Zero();  // Σ w j jᵀ
  Vector5 score = Vector5::Zero();      // Σ ψ j
  int count = 0;
  double clean = 0, inked = 0, depth = 0, noise_sq = 0;
  // Of the last pass only.
  Matrix5 information = Matrix5::Zero();  // Σ ψ² j jᵀ: what the points tell (Fisher)
  double information_sum = 0;
  SectorSums sectors;
  int points = 0;
};

void add_outer(double weight, const double (&j)[5], Matrix5& sum) {
  for (int m = 0; m < 5; ++m) {
    for (int n = 0; n <= m; ++n) sum(m, n) += weight * j[m] * j[n];
  }
}

// Residual of a point from the rim corrected by `delta`.
double excess_beyond(const RimPoint& p, const Vector5& delta) {
  const double c = p.cos, s = p.sin;
  return p.excess - (c * delta[0] + s * delta[1] + delta[2] + (c * c - s * s) * delta[3] +
                     2 * c * s * delta[4]);
}

enum class Pass { kLearning, kLast };

template <Pass kPass>
Sums accumulate(const RimTrace& trace, const Vector5& delta, const Mixture& mixture, int stride) {
  Sums s;
  const CrossingDensity density(mixture);
  for (std::size_t i = 0; i < trace.points.size(); i += stride) {
    const RimPoint& p = trace.points[i];
    const double c = p.cos, sn = p.sin;
    const double j[5] = {c, sn, 1, c * c - sn * sn, 2 * c * sn};
    const double r = excess_beyond(p, delta);
    // In units in which all points err alike.
    const ResidualEvidence e = density(r * p.weight);
    const double once = p.weight, twice = once * once;
    ++s.count;
    add_outer(twice * e.curvature, j, s.curvature);
    for (int m = 0; m < 5; ++m) s.score[m] += once * e.score * j[m];
    s.clean += e.clean;
    s.inked += e.inked;
    s.depth += e.inked * e.depth;
    s.noise_sq += e.noise_sq;
    if constexpr (kPass == Pass::kLast) {
      add_outer(twice * e.score * e.score, j, s.information);
      s.information_sum += e.score * e.score;
      s.sectors.score[p.sector] += e.score;
      s.sectors.information[p.sector] += e.score * e.score;
      if (e.clean + e.inked > 0.5) {
        ++s.sectors.points[p.sector];
        ++s.points;
      }
    }
  }
  s.curvature.triangularView<Eigen::StrictlyUpper>() = s.curvature.transpose();
  s.information.triangularView<Eigen::StrictlyUpper>() = s.information.transpose();
  return s;
}

// The mixture that fits the residuals better (a step of expectation maximisation). The noise is
// never less than the camera's.
Mixture improve(const Sums& s, const Mixture& old, double noise_px) {
  // Over-relaxed: one and a half times the plain step, in the logarithm.
  const auto toward = [](double from, double to, double least, double most) {
    return std::clamp(to * std::sqrt(to / from), std::max(least, kCrossingFit.least_ratio * from),
                      std::min(most, kCrossingFit.most_ratio * from));
  };
  Mixture m;
  m.clean = toward(old.clean, s.clean / s.count, kCrossingFit.least_clean, kCrossingFit.most_share);
  m.inked = toward(old.inked, s.inked / s.count, kCrossingFit.least_inked, kCrossingFit.most_share);
  const double strays =
      std::max((s.count - s.clean - s.inked) / s.count, kCrossingFit.least_strays);
  const double sum = m.clean + m.inked + strays;
  m.clean /= sum;
  m.inked /= sum;
  const double sigma = std::sqrt(s.noise_sq / std::max(s.clean + s.inked, 1e-9));
  m.sigma = std::max(
      toward(old.sigma, sigma, kCrossingFit.least_sigma_px, kCrossingFit.most_step_sigma_px),
      noise_px);
  m.most_sigma = old.most_sigma;
  m.sigma = std::max(std::min(m.sigma, m.most_sigma), kCrossingFit.sigma_fall * old.sigma);
  // Depths like the noise could not be told from it.
  m.tau = std::max(toward(old.tau, s.depth / std::max(s.inked, 1e-9), kCrossingFit.least_tau_px,
                          kCrossingFit.most_tau_px),
                   kCrossingFit.tau_of_sigma * m.sigma);
  return m;
}

// What is fitted to what.
struct RimTask {
  const RimTrace& trace;
  const Rim& rim;
  const CirclePrior& prior;
  Shape shape = Shape::kCircle;

  // A blurred disc's half level lies so far inside its rim.
  double shrink_px() const { return trace.edge_sigma_px * trace.edge_sigma_px / (2 * rim.r); }
  Knowledge known(const Vector5& delta) const {
    return knowledge(rim, delta, prior, shape, shrink_px());
  }
};

// One step of the corrections by the curvature were it known which kind every point is; returns how
// far it went, px.
double improve_delta(const RimTask& task, const Sums& s, double wider, Vector5& delta) {
  const Knowledge known = task.known(delta);
  const Vector5 gradient = s.score / wider + known.pull - known.precision * delta;
  const Vector5 step = Eigen::LDLT<Matrix5>(s.curvature / wider + known.precision).solve(gradient);
  delta += step;
  return step.cwiseAbs().maxCoeff();
}

// Learns corrections and mixture from a part of the points. False where they run away.
bool learn(const RimTask& task, Vector5& delta, Mixture& mixture) {
  const int points = static_cast<int>(task.trace.points.size());
  const int stride = std::max<int>(1, points / kCrossingFit.learn_from);
  for (int pass = 0; pass < kCrossingFit.learning; ++pass) {
    const Sums s = accumulate<Pass::kLearning>(task.trace, delta, mixture, stride);
    const double moved = improve_delta(task, s, 1, delta);
    const Mixture next = improve(s, mixture, task.trace.noise_px);
    const bool settled = moved < kCrossingFit.learnt * mixture.sigma &&
                         std::abs(next.sigma - mixture.sigma) < kCrossingFit.learnt * next.sigma &&
                         std::abs(next.clean - mixture.clean) < kCrossingFit.learnt_share;
    mixture = next;
    if (!std::isfinite(moved)) return false;
    if (settled) break;
  }
  return true;
}

// What the last sums say of the corrections found.
RimEstimate describe(const RimTask& task, const Sums& s, const Vector5& delta, double wider,
                     double sigma) {
  RimEstimate result;
  result.ok = true;
  result.delta = delta;
  const Knowledge known = task.known(delta);
  const Matrix5 precision = s.information / wider + known.precision;
  result.covariance = Eigen::LDLT<Matrix5>(precision).solve(Matrix5::Identity());
  for (int i = 0; i < 2; ++i) {
    result.with_radius[i] = result.covariance(i, 2) / result.covariance(2, 2);
  }
  RadiusShare share = radius_share(known, precision, result.covariance, delta);
  // A scatter that the camera does not explain is fine ink all along the rim, or a rough ball: the
  // ink moves every crossing inwards, by more than it scatters them.
  const double trusted = kCrossingFit.noise_trust * task.trace.noise_px;
  const double beyond = sigma * sigma - trusted * trusted;
  const double shifted = kCrossingFit.ink_shift * kCrossingFit.ink_shift * std::max(0.0, beyond);
  result.covariance(2, 2) += shifted;
  share.alone(2, 2) += shifted;
  result.own = own_radius(share, task.rim.r + delta[2]);
  if (task.shape == Shape::kCircle) result.oval = score_test(s.information, s.score, wider);
  result.scale = sigma;
  result.points = s.points;
  for (int count : s.sectors.points) result.arc += count > 0 ? 1.0 / kRimSectors : 0;
  return result;
}

// Corrections and mixture from `delta` and `mixture` on: both are learnt from a part of the points,
// then the corrections settle on all of them.
RimEstimate estimate(const RimTask& task, Vector5 delta, Mixture& mixture) {
  if (!learn(task, delta, mixture)) return {};
  const int parameters = task.shape == Shape::kEllipse ? 5 : 3;
  for (int pass = 0;; ++pass) {
    const Sums s = accumulate<Pass::kLast>(task.trace, delta, mixture, 1);
    if (s.points < 3 * parameters) return {};
    const double wider =
        inflation(s.sectors, s.information_sum, kCrossingFit.common_px, parameters);
    const double moved = improve_delta(task, s, wider, delta);
    if (!std::isfinite(moved)) return {};
    if (moved > kCrossingFit.refined * mixture.sigma && pass + 1 < kCrossingFit.refining) continue;
    return describe(task, s, delta, wider, mixture.sigma);
  }
}

double log_likelihood(const RimTrace& trace, const Vector5& delta, const Mixture& mixture) {
  const CrossingDensity density(mixture);
  double sum = 0;
  for (const RimPoint& p : trace.points) {
    sum += std::log(density(excess_beyond(p, delta) * p.weight).total);
  }
  return sum;
}

// The better of two explanations of a wide scatter: rough edges, or ink in most of them with the
// camera's noise.
RimEstimate explain_from(const Vector5& start, const RimTask& task, Mixture& mixture) {
  const RimEstimate rough = estimate(task, start, mixture);
  const double most = kCrossingFit.noise_trust * task.trace.noise_px;
  if (rough.ok && mixture.sigma <= most) return rough;
  Mixture inked{
      .clean = kCrossingFit.other_clean, .inked = kCrossingFit.other_inked, .most_sigma = most};
  const RimEstimate other = estimate(task, start, inked);
  if (rough.ok && !(other.ok && log_likelihood(task.trace, other.delta, inked) >
                                    log_likelihood(task.trace, rough.delta, mixture))) {
    return rough;
  }
  mixture = inked;
  return other;
}

// Each start leads to the maximum of the likelihood next to it. Where that takes many points for
// strays, the one next to the rim that the rays were cast about may be likelier, and explain them:
// where neither does, as in texture, there may be no rim.
RimEstimate explain(const RimTask& task, const Vector5& start, Mixture& mixture) {
  const RimEstimate found = explain_from(start, task, mixture);
  const double enough = kCrossingFit.explained * static_cast<double>(task.trace.points.size());
  if (!found.ok || found.points >= enough) return found;
  Mixture other;
  const RimEstimate near = explain_from(Vector5::Zero(), task, other);
  if (!near.ok || near.points < enough ||
      log_likelihood(task.trace, found.delta, mixture) >=
          log_likelihood(task.trace, near.delta, other)) {
    return found;
  }
  mixture = other;
  return near;
}

// A first radius: nine tenths of the crossings lie inside it.
Vector5 outer(const RimTrace& trace) {
  thread_local std::vector<float> scratch;  // memory only
  scratch.clear();
  for (const RimPoint& p : trace.points) scratch.push_back(p.excess);
  return Vector5::Unit(2) * static_cast<double>(quantile(scratch, kCrossingFit.first_quantile));
}

}  // namespace

RimFit fit_rim(const RimTrace& trace, const Rim& rim, const CirclePrior& prior, Shapes shapes) {
  RimFit fit;
  fit.rim = rim;
  if (trace.points.size() < kCrossingFit.least_points) return fit;
  const Vector5 start = outer(trace);
  const RimTask round{trace, rim, prior, Shape::kCircle},
      squashed{trace, rim, prior, Shape::kEllipse};
  RimEstimate best;
  // A circle where the search saw none but small deviations, unless its residuals object.
  Mixture mixture;
  const bool only = shapes == Shapes::kCircle;
  if (only || std::hypot(rim.e1, rim.e2) < kPrior.plainly_oval * rim.r) {
    best = explain(round, start, mixture);
  }
  if (!only && !(best.ok && best.oval < kPrior.significant)) {
    Mixture oval_mixture;
    const RimEstimate oval = explain(squashed, start, oval_mixture);
    fit.ellipse = oval.ok && wald(rim, oval.delta, oval.covariance) > kPrior.significant;
    if (fit.ellipse) {
      best = oval;
      mixture = oval_mixture;
    } else if (!best.ok) {
      best = explain(round, start, mixture);
    }
  }
  if (!best.ok) return fit;
  fit.ok = true;
  fit.rim = {rim.cx + best.delta[0], rim.cy + best.delta[1], rim.r + best.delta[2],
             fit.ellipse ? rim.e1 + best.delta[3] : 0, fit.ellipse ? rim.e2 + best.delta[4] : 0};
  for (int i = 0; i < 5; ++i) fit.sd[i] = std::sqrt(std::max(0.0, best.covariance(i, i)));
  std::copy(best.with_radius, best.with_radius + 2, fit.with_radius);
  fit.own = best.own;
  fit.residual_px = best.scale;
  fit.inked = mixture.inked;
  fit.points = best.points;
  fit.arc = best.arc;
  return fit;
}

}  // namespace impactdic::circle
