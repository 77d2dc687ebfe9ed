#include "host/dic/rigid_fit.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace impactdic {
namespace {

// Points of the plane as complex numbers, x + iy in image axes. With y down, a turn by θ
// counter-clockwise as seen on the screen is a factor e^{−iθ}. (std::complex looks for infinities
// in every product.)
struct Complex {
  double x = 0, y = 0;
};
Complex operator+(Complex a, Complex b) { return {a.x + b.x, a.y + b.y}; }
Complex operator-(Complex a, Complex b) { return {a.x - b.x, a.y - b.y}; }
Complex operator*(Complex a, Complex b) { return {a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x}; }
Complex operator*(double a, Complex b) { return {a * b.x, a * b.y}; }
Complex conj(Complex a) { return {a.x, -a.y}; }
double norm(Complex a) { return a.x * a.x + a.y * a.y; }
double length(Complex a) { return std::sqrt(norm(a)); }

constexpr int kHypotheses = 60;
constexpr int kRounds = 30;
// Tukey's constant for 95 % efficiency on one normal component, and the median of the length of a
// two-dimensional normal residual.
constexpr double kTukey = 4.685, kRayleighMedian = 1.17741;
// Residuals smaller than this (in units of the points' sd) are not told apart.
constexpr double kSmallestScale = 1e-3;

struct Pair {
  Complex from, to;
  double per_sd;
};

struct Motion {
  // to = turn · from + skew · conj(from) + shift; rigid where |turn| = 1 and skew = 0.
  Complex turn{1, 0}, shift{0, 0}, skew{0, 0};
  Complex operator()(Complex z) const { return turn * z + skew * conj(z) + shift; }
};

// Squared residual in units of the point's sd.
double residual_sq(const Motion& motion, const Pair& pair) {
  return norm(pair.to - motion(pair.from)) * pair.per_sd * pair.per_sd;
}

// Of every `stride`th pair.
double median_residual(const Motion& motion, const std::vector<Pair>& pairs,
                       std::size_t stride = 1) {
  thread_local std::vector<double> squares;  // memory only
  squares.clear();
  for (std::size_t i = 0; i < pairs.size(); i += stride) {
    squares.push_back(residual_sq(motion, pairs[i]));
  }
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  return std::sqrt(*middle);
}

struct Sums {
  double weight = 0, inertia = 0;
  Complex centroid, moved;
};

// Weighted Procrustes: the turn is the phase of Σ w conj(from − centroid)(to − moved).
Motion fit(const std::vector<Pair>& pairs, const std::vector<double>& weights, Sums& sums) {
  sums = {};
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    sums.weight += weights[i];
    sums.centroid = sums.centroid + weights[i] * pairs[i].from;
    sums.moved = sums.moved + weights[i] * pairs[i].to;
  }
  sums.centroid = (1 / sums.weight) * sums.centroid;
  sums.moved = (1 / sums.weight) * sums.moved;
  Complex product;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Complex arm = pairs[i].from - sums.centroid;
    product = product + weights[i] * (conj(arm) * (pairs[i].to - sums.moved));
    sums.inertia += weights[i] * norm(arm);
  }
  Motion motion;
  if (norm(product) > 0) motion.turn = (1 / length(product)) * product;
  motion.shift = sums.moved - motion.turn * sums.centroid;
  return motion;
}

// Least median of residuals over motions through two points each (Rousseeuw 1984): right while
// fewer than half of the points are wrong. The median is that of a part of the points, and a motion
// that explains them to their deviations ends the search.
Motion consensus(const std::vector<Pair>& pairs) {
  constexpr std::size_t kLookedAt = 100;
  constexpr int kFewest = 12;
  constexpr double kAsGoodAsTheNoise = 2;
  const std::size_t stride = std::max<std::size_t>(1, pairs.size() / kLookedAt);
  Motion best;
  double least = INFINITY;
  std::uint32_t state = 12345;  // a fixed sequence: the same points give the same motion
  const auto next = [&] {
    state = state * 1664525u + 1013904223u;
    return (state >> 8) % pairs.size();
  };
  for (int k = 0; k < kHypotheses; ++k) {
    if (k >= kFewest && least < kAsGoodAsTheNoise) break;
    const Pair &a = pairs[next()], &b = pairs[next()];
    const Complex turned = (b.to - a.to) * conj(b.from - a.from);
    if (norm(turned) == 0) continue;
    Motion motion;
    motion.turn = (1 / length(turned)) * turned;
    motion.shift = 0.5 * ((a.to + b.to) - motion.turn * (a.from + b.from));
    const double typical = median_residual(motion, pairs, stride);
    if (typical < least) {
      least = typical;
      best = motion;
    }
  }
  return best;
}

// The same with a uniform strain on top: linear least squares for turn and skew. False where the
// points lie on a line.
bool fit_strained(const std::vector<Pair>& pairs, const std::vector<double>& weights, Sums& sums,
                  Motion& motion) {
  fit(pairs, weights, sums);
  Complex squares, with, against;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Complex arm = pairs[i].from - sums.centroid, moved = pairs[i].to - sums.moved;
    squares = squares + weights[i] * (arm * arm);
    with = with + weights[i] * (conj(arm) * moved);
    against = against + weights[i] * (arm * moved);
  }
  const double determinant = sums.inertia * sums.inertia - norm(squares);
  if (!(determinant > 1e-6 * sums.inertia * sums.inertia)) return false;
  motion.turn = (1 / determinant) * (sums.inertia * with - conj(squares) * against);
  motion.skew = (1 / determinant) * (sums.inertia * against - squares * with);
  motion.shift = sums.moved - motion.turn * sums.centroid - motion.skew * conj(sums.centroid);
  return true;
}

// Of a squared residual over the squared cut.
double tukey(double q_sq) { return q_sq < 1 ? (1 - q_sq) * (1 - q_sq) : 0; }

void weigh(const Motion& motion, const std::vector<Pair>& pairs, double cut,
           std::vector<double>& weights) {
  const double per_cut_sq = 1 / (cut * cut);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    weights[i] =
        tukey(residual_sq(motion, pairs[i]) * per_cut_sq) * (pairs[i].per_sd * pairs[i].per_sd);
  }
}

// Steps far below any point's deviation.
bool settled(const Motion& motion, const Motion& before) {
  return length(motion.turn - before.turn) < 1e-11 && length(motion.shift - before.shift) < 1e-9;
}

double cut_of(const Motion& motion, const std::vector<Pair>& pairs) {
  return kTukey * std::max(median_residual(motion, pairs) / kRayleighMedian, kSmallestScale);
}

double sum_of_squares(const Motion& motion, const std::vector<Pair>& pairs,
                      const std::vector<double>& weights) {
  double sum = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    sum += weights[i] * norm(pairs[i].to - motion(pairs[i].from));
  }
  return sum;
}

// A ball that is being compressed has no rigid motion: Tukey's weights would keep the windows of
// one side of it, and the centre would move with that side. So a uniform strain is fitted too, and
// taken where it explains what chance (three unknowns more) does not; then `motion`, `weights`,
// `sums` and `cut` are those of that fit.
void take_strain(const std::vector<Pair>& pairs, Motion& motion, std::vector<double>& weights,
                 Sums& sums, double& cut) {
  constexpr std::size_t kFewest = 12;
  constexpr double kSignificant = 30;
  // A few odd windows at the rim look like a weak strain; one that matters halves the residuals.
  constexpr double kClearly = 0.6, kHopeless = 0.85;
  if (pairs.size() < kFewest) return;
  const double rigid_scatter = median_residual(motion, pairs);
  Motion strained = motion;
  double wide = cut_of(motion, pairs);
  std::vector<double> kept(pairs.size());
  Sums strained_sums;
  for (int round = 0; round < kRounds; ++round) {
    weigh(strained, pairs, wide, kept);
    const Motion before = strained;
    if (!fit_strained(pairs, kept, strained_sums, strained)) return;
    // The scatter shrinks as the strain is found; then the cut stays.
    if (round < 5) wide = std::min(wide, cut_of(strained, pairs));
    if (round == 1 && median_residual(strained, pairs) > kHopeless * rigid_scatter) return;
    if (round >= 5 && settled(strained, before)) break;
  }
  const double counted =
      static_cast<double>(std::count_if(kept.begin(), kept.end(), [](double w) { return w > 0; }));
  if (counted < static_cast<double>(pairs.size()) / 2 || counted < kFewest) return;
  Sums rigid_sums;
  const double rest = sum_of_squares(strained, pairs, kept);
  const double rigid = sum_of_squares(fit(pairs, kept, rigid_sums), pairs, kept);
  if (!(rigid - rest > kSignificant * rest / (2 * counted - 6))) return;
  if (!(median_residual(strained, pairs) < kClearly * rigid_scatter)) return;
  motion = strained;
  weights = kept;
  sums = strained_sums;
  cut = wide;
}

// Variance of one residual component as the M-estimator sees it (Huber 1981, eq. 6.6):
// mean ψ² over the square of mean ψ', in units of the points' variance.
double effective_variance(const Motion& motion, const std::vector<Pair>& pairs, double cut) {
  double psi2 = 0, slope = 0;
  for (const Pair& pair : pairs) {
    const double squared = residual_sq(motion, pair), q_sq = squared / (cut * cut);
    if (q_sq >= 1) continue;
    const double weight = tukey(q_sq);
    psi2 += weight * weight * squared;
    slope += 2 * weight - 4 * (1 - q_sq) * q_sq;
  }
  const double n = 2.0 * static_cast<double>(pairs.size());
  return slope > 0 ? psi2 * n * n / ((n - 3) * slope * slope) : INFINITY;
}

}  // namespace

RigidMotion fit_rigid_motion(std::span<const PointMotion> points, double cx_px, double cy_px) {
  RigidMotion result;
  if (points.size() < 3) return result;
  const Complex centre{cx_px, cy_px};
  std::vector<Pair> pairs;
  pairs.reserve(points.size());
  for (const PointMotion& p : points) {
    const Complex from = Complex{p.x_px, p.y_px} - centre;
    pairs.push_back({from, from + Complex{p.u_px, p.v_px}, 1 / p.sd_px});
  }
  Motion motion = consensus(pairs);
  // The scatter of the consensus sets the cut once; it must not follow the weights down.
  const double scale = std::max(median_residual(motion, pairs) / kRayleighMedian, kSmallestScale) *
                       (1 + 5.0 / (2.0 * static_cast<double>(pairs.size())));
  double cut = kTukey * scale;
  std::vector<double> weights(pairs.size());
  Sums sums;
  for (int round = 0; round < kRounds; ++round) {
    weigh(motion, pairs, cut, weights);
    if (std::count_if(weights.begin(), weights.end(), [](double w) { return w > 0; }) < 3) {
      return result;
    }
    const Motion before = motion;
    motion = fit(pairs, weights, sums);
    // After the first round the scatter about the fit, not about two points, sets the cut.
    if (round == 0) {
      cut = cut_of(motion, pairs);
    }
    if (round > 0 && settled(motion, before)) break;
  }
  take_strain(pairs, motion, weights, sums, cut);
  if (sums.inertia <= 0) return result;

  double full_weight = 0, full_inertia = 0, squares = 0, counted = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double w = pairs[i].per_sd * pairs[i].per_sd;
    full_weight += w;
    full_inertia += w * norm(pairs[i].from - sums.centroid);
    const double share = weights[i] / w;
    counted += share;
    squares += share * norm(pairs[i].to - motion(pairs[i].from));
    result.used += share > 0;
  }
  const double variance = effective_variance(motion, pairs, cut);
  const double shift_variance = variance / full_weight;
  const double turn_variance = variance / full_inertia;
  result.ok = std::isfinite(variance);
  result.dx_px = motion.shift.x;
  result.dy_px = motion.shift.y;
  result.rot_rad = -std::atan2(motion.turn.y, motion.turn.x);
  result.rot_sd_rad = std::sqrt(turn_variance);
  // The centre lies `centroid` away from where the translation is known best.
  result.dx_sd_px = std::sqrt(shift_variance + turn_variance * sums.centroid.y * sums.centroid.y);
  result.dy_sd_px = std::sqrt(shift_variance + turn_variance * sums.centroid.x * sums.centroid.x);
  result.residual_px = std::sqrt(squares / (2 * counted));
  return result;
}

}  // namespace impactdic
