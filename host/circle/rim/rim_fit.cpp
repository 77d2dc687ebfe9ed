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

#include "host/circle/rim/rim.h"
#include "host/circle/rim/rim_prior.h"

namespace impactdic::circle {
namespace {

constexpr int kLearning = 40, kRefining = 5;  // steps at most
constexpr int kLearnFrom = 140;               // points at least, where there are as many
constexpr double kNoiseTrust = 1.5;
constexpr double kCommon_px = 0.008;  // leaves 0.0015 px of a centre, as pictures without noise do
constexpr double kInkShift = 2;       // of fine ink over the scatter it makes (pattern a3)

// One fit: corrections to the rim, their covariance, and what the residuals say.
struct Estimate {
  bool ok = false;
  Vector5 delta = Vector5::Zero();
  Matrix5 covariance = Matrix5::Zero();
  double scale = 0;  // scatter of the clean points
  int points = 0;
  double arc = 0;
  double oval = 0;  // of a circle: χ² that its residuals hold against it, 2 degrees of freedom
};

// How residuals are distributed. A clean edge errs by the noise, N(0, σ). Ink that reaches into
// the edge darkens it and so moves the crossing inwards by some depth, exponential with mean τ,
// before the noise: the composed error of a stochastic frontier (Aigner, Lovell and Schmidt,
// 1977; Meeusen and van den Broeck, 1977). A few points have nothing to do with the rim.
struct Mixture {
  double clean = 0.7, inked = 0.29;  // shares; the rest are strays
  double sigma = 0.15, tau = 0.5;    // px
  double most_sigma = 1;             // px
};
constexpr double kStrays_per_px = 0.25;  // density of a stray, over the crossings' range of 4 px

// What one residual says under a mixture.
struct Evidence {
  double total;            // density
  double clean, inked;     // posterior shares
  double score;            // −∂ ln p / ∂r
  double curvature;        // −∂² ln p / ∂r² were it known which kind the point is
  double depth, noise_sq;  // expected depth if inked; expected squared noise, either kind
};

// φ(a) / Φ(−a), the inverse of Mills' ratio, from a table of values 1/64 apart; error < 1e-5.
class InverseMills {
 public:
  InverseMills() {
    for (int i = 0; i <= 2 * kReach * kPerUnit; ++i) {
      const double a = static_cast<double>(i) / kPerUnit - kReach;
      table_[i] = std::exp(-0.5 * a * a) / (std::sqrt(kPi / 2) * std::erfc(a / std::sqrt(2.0)));
    }
  }
  double operator()(double a) const {
    if (a <= -kReach) return 0;
    if (a >= kReach) return a + 1 / a - 2 / (a * a * a);
    const double at = (a + kReach) * kPerUnit;
    const int i = static_cast<int>(at);
    return table_[i] + (at - i) * (table_[i + 1] - table_[i]);
  }

 private:
  static constexpr int kReach = 10, kPerUnit = 64;
  std::array<double, 2 * kReach * kPerUnit + 2> table_{};
};

// A mixture with what every evaluation needs of it.
class Density {
 public:
  explicit Density(const Mixture& m)
      : m_(m),
        per_sigma_(1 / m.sigma),
        precision_(per_sigma_ * per_sigma_),
        ratio_(m.sigma / m.tau),
        peak_(per_sigma_ / std::sqrt(2 * kPi)),
        strays_((1 - m.clean - m.inked) * kStrays_per_px) {}

  Evidence operator()(double r) const {
    const double z = r * per_sigma_, a = z + ratio_;
    const double normal = std::abs(z) < 8 ? std::exp(-0.5 * z * z) * peak_ : 0;
    const double mills = inverse_mills_(a);
    // exp(r/τ + σ²/2τ²) Φ(−a) / τ, by way of N(r; 0, σ) where that does not vanish.
    const double skewed =
        a > -4 ? normal * ratio_ / mills : std::exp(ratio_ * (z + 0.5 * ratio_)) / m_.tau;
    const double clean = m_.clean * normal, inked = m_.inked * skewed;
    const double per_total = 1 / (clean + inked + strays_);
    Evidence e;
    e.total = clean + inked + strays_;
    e.clean = clean * per_total;
    e.inked = inked * per_total;
    // The depth given r is normal about −σ·a with σ, cut off at 0; `share` is its variance / σ².
    const double share = std::clamp(1 + a * mills - mills * mills, 0.0, 1.0);
    e.depth = m_.sigma * (mills - a);
    const double noise_inked = r + e.depth;
    const double score_clean = r * precision_, score_inked = noise_inked * precision_;
    e.score = e.clean * score_clean + e.inked * score_inked;
    e.curvature = precision_ * (e.clean + e.inked * (1 - share));
    e.noise_sq =
        e.clean * r * r + e.inked * (noise_inked * noise_inked + share * m_.sigma * m_.sigma);
    return e;
  }

 private:
  static const InverseMills inverse_mills_;
  Mixture m_;
  double per_sigma_, precision_, ratio_, peak_, strays_;
};
const InverseMills Density::inverse_mills_;

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

template <bool kLast>
Sums accumulate(const RimTrace& trace, const Vector5& delta, const Mixture& mixture, int stride) {
  Sums s;
  const Density density(mixture);
  for (std::size_t i = 0; i < trace.points.size(); i += stride) {
    const RimPoint& p = trace.points[i];
    const double c = p.cos, sn = p.sin;
    const double j[5] = {c, sn, 1, c * c - sn * sn, 2 * c * sn};
    const double r = excess_beyond(p, delta);
    // In units in which all points err alike.
    const Evidence e = density(r * p.weight);
    const double once = p.weight, twice = once * once;
    ++s.count;
    add_outer(twice * e.curvature, j, s.curvature);
    for (int m = 0; m < 5; ++m) s.score[m] += once * e.score * j[m];
    s.clean += e.clean;
    s.inked += e.inked;
    s.depth += e.inked * e.depth;
    s.noise_sq += e.noise_sq;
    if constexpr (kLast) {
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
    return std::clamp(to * std::sqrt(to / from), std::max(least, 0.4 * from),
                      std::min(most, 2.5 * from));
  };
  Mixture m;
  m.clean = toward(old.clean, s.clean / s.count, 0.02, 0.99);
  m.inked = toward(old.inked, s.inked / s.count, 0.005, 0.99);
  const double strays = std::max((s.count - s.clean - s.inked) / s.count, 5e-3);
  const double sum = m.clean + m.inked + strays;
  m.clean /= sum;
  m.inked /= sum;
  const double sigma = std::sqrt(s.noise_sq / std::max(s.clean + s.inked, 1e-9));
  m.sigma = std::max(toward(old.sigma, sigma, 0.002, 1.0), noise_px);
  m.most_sigma = old.most_sigma;
  m.sigma = std::max(std::min(m.sigma, m.most_sigma), 0.6 * old.sigma);
  // Depths like the noise could not be told from it.
  m.tau = std::max(toward(old.tau, s.depth / std::max(s.inked, 1e-9), 0.05, 2.0), 3 * m.sigma);
  return m;
}

// Corrections and mixture from `delta` and `mixture` on: both are learnt from a part of the points,
// then the corrections settle on all of them.
Estimate estimate(const RimTrace& trace, const Rim& rim, const CirclePrior& prior, bool ellipse,
                  Vector5 delta, Mixture& mixture, double shrink_px) {
  Estimate result;
  const int parameters = ellipse ? 5 : 3;
  double wider = 1;
  const auto improve_delta = [&](const Sums& s) {
    const Knowledge known = knowledge(rim, delta, prior, ellipse, shrink_px);
    const Vector5 gradient = s.score / wider + known.pull - known.precision * delta;
    const Vector5 step =
        Eigen::LDLT<Matrix5>(s.curvature / wider + known.precision).solve(gradient);
    delta += step;
    return step.cwiseAbs().maxCoeff();
  };

  const int stride = std::max<int>(1, static_cast<int>(trace.points.size()) / kLearnFrom);
  for (int pass = 0; pass < kLearning; ++pass) {
    const Sums s = accumulate<false>(trace, delta, mixture, stride);
    const double moved = improve_delta(s);
    const Mixture next = improve(s, mixture, trace.noise_px);
    const bool settled = moved < 0.05 * mixture.sigma &&
                         std::abs(next.sigma - mixture.sigma) < 0.05 * next.sigma &&
                         std::abs(next.clean - mixture.clean) < 0.02;
    mixture = next;
    if (!std::isfinite(moved)) return result;
    if (settled) break;
  }
  for (int pass = 0;; ++pass) {
    const Sums s = accumulate<true>(trace, delta, mixture, 1);
    if (s.points < 3 * parameters) return result;
    wider = inflation(s.sectors, s.information_sum, kCommon_px, parameters);
    const double moved = improve_delta(s);
    if (!std::isfinite(moved)) return result;
    if (moved > 0.01 * mixture.sigma && pass + 1 < kRefining) continue;
    const Knowledge known = knowledge(rim, delta, prior, ellipse, shrink_px);
    result.ok = true;
    result.delta = delta;
    result.covariance =
        Eigen::LDLT<Matrix5>(s.information / wider + known.precision).solve(Matrix5::Identity());
    // A scatter that the camera does not explain is fine ink all along the rim, or a rough ball:
    // the ink moves every crossing inwards, by more than it scatters them.
    const double trusted = kNoiseTrust * trace.noise_px;
    const double beyond = mixture.sigma * mixture.sigma - trusted * trusted;
    result.covariance(2, 2) += kInkShift * kInkShift * std::max(0.0, beyond);
    if (!ellipse) result.oval = score_test(s.information, s.score, wider);
    result.scale = mixture.sigma;
    result.points = s.points;
    for (int count : s.sectors.points) result.arc += count > 0 ? 1.0 / kRimSectors : 0;
    return result;
  }
}

double log_likelihood(const RimTrace& trace, const Vector5& delta, const Mixture& mixture) {
  const Density density(mixture);
  double sum = 0;
  for (const RimPoint& p : trace.points) {
    sum += std::log(density(excess_beyond(p, delta) * p.weight).total);
  }
  return sum;
}

// The better of two explanations of a wide scatter: rough edges, or ink in most of them with the
// camera's noise.
Estimate explain(const RimTrace& trace, const Rim& rim, const CirclePrior& prior, bool ellipse,
                 const Vector5& start, Mixture& mixture, double shrink_px) {
  const Estimate rough = estimate(trace, rim, prior, ellipse, start, mixture, shrink_px);
  const double most = kNoiseTrust * trace.noise_px;
  if (rough.ok && mixture.sigma <= most) return rough;
  Mixture inked{.clean = 0.2, .inked = 0.79, .most_sigma = most};
  const Estimate other = estimate(trace, rim, prior, ellipse, start, inked, shrink_px);
  if (rough.ok && !(other.ok && log_likelihood(trace, other.delta, inked) >
                                    log_likelihood(trace, rough.delta, mixture))) {
    return rough;
  }
  mixture = inked;
  return other;
}

// A first radius: nine tenths of the crossings lie inside it.
Vector5 outer(const RimTrace& trace) {
  thread_local std::vector<float> scratch;  // memory only
  scratch.clear();
  for (const RimPoint& p : trace.points) scratch.push_back(p.excess);
  const auto rank = scratch.begin() + static_cast<std::ptrdiff_t>(0.9 * scratch.size());
  std::nth_element(scratch.begin(), rank, scratch.end());
  return Vector5::Unit(2) * *rank;
}

}  // namespace

RimFit fit_rim(const RimTrace& trace, const Rim& rim, const CirclePrior& prior,
               bool allow_ellipse) {
  RimFit fit;
  fit.rim = rim;
  if (trace.points.size() < 15) return fit;
  const double shrink = trace.edge_sigma_px * trace.edge_sigma_px / (2 * rim.r);
  const Vector5 start = outer(trace);
  Estimate best;
  // A circle where the search saw none but small deviations, unless its residuals object.
  Mixture mixture;
  if (!allow_ellipse || std::hypot(rim.e1, rim.e2) < kPlainlyOval * rim.r) {
    best = explain(trace, rim, prior, false, start, mixture, shrink);
  }
  if (allow_ellipse && !(best.ok && best.oval < kSignificant)) {
    Mixture oval_mixture;
    const Estimate oval = explain(trace, rim, prior, true, start, oval_mixture, shrink);
    fit.ellipse = oval.ok && wald(rim, oval.delta, oval.covariance) > kSignificant;
    if (fit.ellipse) {
      best = oval;
      mixture = oval_mixture;
    } else if (!best.ok) {
      best = explain(trace, rim, prior, false, start, mixture, shrink);
    }
  }
  if (!best.ok) return fit;
  fit.ok = true;
  fit.rim = {rim.cx + best.delta[0], rim.cy + best.delta[1], rim.r + best.delta[2],
             fit.ellipse ? rim.e1 + best.delta[3] : 0, fit.ellipse ? rim.e2 + best.delta[4] : 0};
  for (int i = 0; i < 5; ++i) fit.sd[i] = std::sqrt(std::max(0.0, best.covariance(i, i)));
  fit.residual_px = best.scale;
  fit.inked = mixture.inked;
  fit.points = best.points;
  fit.arc = best.arc;
  return fit;
}

}  // namespace impactdic::circle
