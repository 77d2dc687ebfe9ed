#include "host/dic/rigid_fit.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "host/dic/point_columns.h"

namespace impactdic::dic {
namespace {

using Eigen::ArrayXf;

constexpr int kHypotheses = 60;
constexpr int kRounds = 30;
// Tukey's constant for 95 % efficiency on one normal component, and the median of the length of a
// two-dimensional normal residual.
constexpr double kTukey = 4.685, kRayleighMedian = 1.17741;
// Residuals smaller than this (in units of the points' sd) are not told apart.
constexpr double kSmallestScale = 1e-3;

// Median of the residuals' lengths in units of the points' deviations. `squares`: memory that is
// asked for once a fit; the threads that fit wait for each other where they ask for it.
float median_residual(const AffineMotion& motion, const PointColumns& points, ArrayXf& squares) {
  squares = points.residuals_sq(motion) * points.per_variance;
  return std::sqrt(upper_median(squares));
}

// Least median of residuals over rigid motions through two points each (Rousseeuw 1984): right
// while fewer than half of the points are wrong. The median is that of a part of the points, and a
// motion that explains them to their deviations ends the search, but for the first dozen: where
// displacements cluster, as those of a biased method do, the best of few is but one cluster's.
AffineMotion consensus(std::span<const PointMotion> points, double cx_px, double cy_px) {
  constexpr std::size_t kLookedAt = 100;
  constexpr int kFewest = 12;
  constexpr float kAsGoodAsTheNoise = 2;
  const std::size_t stride = std::max<std::size_t>(1, points.size() / kLookedAt);
  const PointColumns some(points, cx_px, cy_px, {}, stride);
  ArrayXf squares;
  AffineMotion best;
  float least = INFINITY;
  std::uint32_t state = 12345;  // a fixed sequence: the same points give the same motion
  const auto next = [&] {
    state = state * 1664525u + 1013904223u;
    return points[(state >> 8) % static_cast<std::uint32_t>(points.size())];
  };
  for (int k = 0; k < kHypotheses; ++k) {
    if (k >= kFewest && least < kAsGoodAsTheNoise) break;
    Sums<double> two(0);
    for (int i = 0; i < 2; ++i) {
      const PointMotion p = next();
      two.add(1, p.x_px - cx_px, p.y_px - cy_px, p.u_px, p.v_px);
    }
    const AffineMotion motion = Moments(two, {}).rigid();
    const float typical = median_residual(motion, some, squares);
    if (typical < least) {
      least = typical;
      best = motion;
    }
  }
  return best;
}

void weigh(const AffineMotion& motion, const PointColumns& points, double cut, ArrayXf& weights) {
  const auto per_cut_sq = static_cast<float>(1 / (cut * cut));
  weights = biweight(per_cut_sq * points.residuals_sq(motion) * points.per_variance) *
            points.per_variance;
}

// Steps far below any point's deviation.
bool settled(const AffineMotion& motion, const AffineMotion& before) {
  constexpr double kGradient = 1e-8, kShift_px = 1e-6;
  return (motion - before).gradient_length() < kGradient &&
         std::hypot(motion.u - before.u, motion.v - before.v) < kShift_px;
}

double cut_of(double median_residual) {
  return kTukey * std::max(median_residual / kRayleighMedian, kSmallestScale);
}

// A robust fit: its motion, and the weights that led to it.
struct RobustFit {
  AffineMotion motion;
  ArrayXf weights;
  double cut = 0;
};

// A ball that is being compressed has no rigid motion: Tukey's weights would keep the windows of
// one side of it, and the centre would move with that side. So a uniform strain is fitted too, and
// taken where it explains what chance (three unknowns more) does not.
void take_strain(const PointColumns& points, RobustFit& fit, ArrayXf& squares) {
  constexpr Eigen::Index kFewest = 12;
  constexpr double kSignificant = 30;
  // A few odd windows at the rim look like a weak strain; one that matters halves the residuals.
  constexpr double kClearly = 0.6, kHopeless = 0.85;
  if (points.size() < kFewest) return;
  const double rigid_scatter = median_residual(fit.motion, points, squares);
  RobustFit strained = fit;
  strained.cut = cut_of(rigid_scatter);
  for (int round = 0; round < kRounds; ++round) {
    weigh(strained.motion, points, strained.cut, strained.weights);
    const Moments moments(points, strained.weights);
    if (moments.on_a_line()) return;
    const AffineMotion before = strained.motion;
    strained.motion = moments.affine();
    // The scatter shrinks as the strain is found; then the cut stays.
    if (round < 5) {
      const double scatter = median_residual(strained.motion, points, squares);
      strained.cut = std::min(strained.cut, cut_of(scatter));
      if (round == 1 && scatter > kHopeless * rigid_scatter) return;
    }
    if (round >= 5 && settled(strained.motion, before)) break;
  }
  const auto counted = static_cast<double>((strained.weights > 0).count());
  if (counted < static_cast<double>(points.size()) / 2 || counted < kFewest) return;
  const auto sum_of_squares = [&](const AffineMotion& motion) {
    return static_cast<double>((strained.weights * points.residuals_sq(motion)).sum());
  };
  const double rest = sum_of_squares(strained.motion);
  const double rigid = sum_of_squares(Moments(points, strained.weights).rigid());
  if (!(rigid - rest > kSignificant * rest / (2 * counted - 6))) return;
  if (!(median_residual(strained.motion, points, squares) < kClearly * rigid_scatter)) return;
  fit = std::move(strained);
}

// Variance of one residual component as the M-estimator sees it (Huber 1981, eq. 6.6):
// mean ψ² over the square of mean ψ', in units of the points' variance.
double effective_variance(const RobustFit& fit, const PointColumns& points) {
  const ArrayXf squared = points.residuals_sq(fit.motion) * points.per_variance;
  const ArrayXf q_sq = static_cast<float>(1 / (fit.cut * fit.cut)) * squared;
  const ArrayXf weight = biweight(q_sq);
  const double psi2 = (weight.square() * squared).sum();
  const double slope = (2 * weight - 4 * (1 - q_sq).max(0.0F) * q_sq).sum();
  const double n = 2.0 * static_cast<double>(points.size());
  return slope > 0 ? psi2 * n * n / ((n - 3) * slope * slope) : INFINITY;
}

// From the consensus, which `points` start from. False where fewer than three points carry weight.
bool fit_robustly(const PointColumns& points, RobustFit& fit) {
  ArrayXf squares;
  fit.motion = points.base;
  // The scatter of the consensus sets the cut once; it must not follow the weights down.
  fit.cut = cut_of(median_residual(fit.motion, points, squares)) *
            (1 + 5.0 / (2.0 * static_cast<double>(points.size())));
  for (int round = 0; round < kRounds; ++round) {
    weigh(fit.motion, points, fit.cut, fit.weights);
    if ((fit.weights > 0).count() < 3) return false;
    const AffineMotion before = fit.motion;
    fit.motion = Moments(points, fit.weights).rigid();
    // After the first round the scatter about the fit, not about two points, sets the cut.
    if (round == 0) fit.cut = cut_of(median_residual(fit.motion, points, squares));
    if (round > 0 && settled(fit.motion, before)) break;
  }
  take_strain(points, fit, squares);
  return true;
}

}  // namespace

RigidMotion fit_rigid_motion(std::span<const PointMotion> measured, double cx_px, double cy_px) {
  RigidMotion result;
  if (measured.size() < 3) return result;
  const PointColumns points(measured, cx_px, cy_px, consensus(measured, cx_px, cy_px));
  RobustFit fit;
  if (!fit_robustly(points, fit)) return result;
  const Moments moments(points, fit.weights);
  if (moments.at_a_point()) return result;

  const ArrayXf share = fit.weights / points.per_variance;
  const double squares = (share * points.residuals_sq(fit.motion)).sum();
  const double full_inertia =
      (points.per_variance * ((points.x - static_cast<float>(moments.x)).square() +
                              (points.y - static_cast<float>(moments.y)).square()))
          .sum();
  const double variance = effective_variance(fit, points);
  const double shift_variance = variance / points.per_variance.sum();
  const double turn_variance = variance / full_inertia;
  const AffineMotion& motion = fit.motion;
  result.used = static_cast<int>((share > 0).count());
  result.ok = std::isfinite(variance);
  result.dx_px = motion.u;
  result.dy_px = motion.v;
  // Of the gradient's part without strain; y points down.
  result.rot_rad = -std::atan2(motion.vx - motion.uy, 2 + motion.ux + motion.vy);
  result.rot_sd_rad = std::sqrt(turn_variance);
  // The centre lies away from where the translation is known best.
  result.dx_sd_px = std::sqrt(shift_variance + turn_variance * moments.y * moments.y);
  result.dy_sd_px = std::sqrt(shift_variance + turn_variance * moments.x * moments.x);
  result.residual_px = std::sqrt(squares / (2.0 * share.sum()));
  return result;
}

}  // namespace impactdic::dic
