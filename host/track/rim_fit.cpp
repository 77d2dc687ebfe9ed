// Circle or ellipse through the traced edges: iteratively re-weighted least squares with Tukey's
// biweight (Holland and Welsch, 1977), about a rim so close that the geometric distance is linear
// in its corrections: excess = x cos φ + y sin φ + dR + de1 cos 2φ + de2 sin 2φ, with an error of
// x²/2R (4e-5 px at x = 0.1 px and R = 115 px; measure_circle traces again from farther away).
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "host/track/rim.h"

namespace impactdic {
namespace {

using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

constexpr double kTukey = 4.685;       // 95 % efficiency on Gaussian errors
constexpr double kWidest_px = 0.3;     // first scale; a search leaves the rim this close
constexpr double kSignificant = 18.4;  // χ² with 2 degrees of freedom exceeds it once in 10 000
constexpr double kTransverse = 0.3;    // of |e|: how far a squashed ball may widen or shrink
constexpr double kAxisTilt = 0.1;      // of |e|: shape across the given compression axis

// One M-estimate: corrections to the rim, their covariance, and what the residuals say.
struct Estimate {
  bool ok = false;
  Vector5 delta = Vector5::Zero();
  Matrix5 covariance = Matrix5::Zero();
  double scale = 0;  // robust scatter of the residuals
  int points = 0;
  double arc = 0;
};

Vector5 row(const RimPoint& p) {
  const double c = p.cos, s = p.sin;
  return {c, s, 1, c * c - s * s, 2 * c * s};
}

double residual(const RimPoint& p, const Vector5& delta) { return p.excess - row(p).dot(delta); }

// What is known beforehand of (x, y, dR, de1, de2), as a quadratic: precision·delta = pull.
struct Knowledge {
  Matrix5 precision = Matrix5::Zero();
  Vector5 pull = Vector5::Zero();
  // direction · delta = value ± sd.
  void add(const Vector5& direction, double value, double sd) {
    precision += direction * direction.transpose() / (sd * sd);
    pull += direction * (value / (sd * sd));
  }
};

// The uncompressed ball's radius and the axis of its compression, for the shape at `delta`.
Knowledge knowledge(const Rim& rim, const Vector5& delta, const CirclePrior& prior, bool ellipse,
                    double shrink_px) {
  Knowledge k;
  const double e1 = rim.e1 + delta[3], e2 = rim.e2 + delta[4];
  const double e = std::hypot(e1, e2);
  if (!ellipse) {
    k.add(Vector5::Unit(3), -rim.e1, 1e-6);
    k.add(Vector5::Unit(4), -rim.e2, 1e-6);
  }
  // Unit vector (in e1, e2) of the long axis: across the compression.
  double u1 = e > 0 ? e1 / e : 1, u2 = e > 0 ? e2 / e : 0;
  if (ellipse && prior.compression_axis_rad) {
    u1 = -std::cos(2 * *prior.compression_axis_rad);
    u2 = -std::sin(2 * *prior.compression_axis_rad);
    Vector5 across = Vector5::Zero();
    across[3] = -u2;
    across[4] = u1;
    k.add(across, u2 * rim.e1 - u1 * rim.e2, kAxisTilt * e + 0.02);
  }
  if (prior.radius_px && prior.radius_sd_px) {
    Vector5 long_axis = Vector5::Unit(2);
    double value = *prior.radius_px - shrink_px - rim.r, sd = *prior.radius_sd_px;
    if (ellipse) {
      long_axis[3] = u1;
      long_axis[4] = u2;
      value -= u1 * rim.e1 + u2 * rim.e2;
      sd = std::hypot(sd, kTransverse * e);
    }
    k.add(long_axis, value, std::max(sd, 1e-4));
  }
  return k;
}

// Median of |residual| · 1.48 over at most some 256 of the points.
double robust_scale(const std::vector<RimPoint>& points, const Vector5& delta,
                    std::vector<float>& scratch) {
  scratch.clear();
  const std::size_t stride = points.size() / 256 + 1;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    scratch.push_back(static_cast<float>(std::abs(residual(points[i], delta))));
  }
  const auto middle = scratch.begin() + static_cast<std::ptrdiff_t>(scratch.size() / 2);
  std::nth_element(scratch.begin(), middle, scratch.end());
  return 1.4826 * *middle;
}

struct Sums {
  Matrix5 a = Matrix5::Zero();  // Σ w j jᵀ
  Vector5 b = Vector5::Zero();  // Σ w j·excess
  double w = 0, psi_sq = 0, psi_slope = 0;
  std::array<double, kRimSectors> sector_psi{};
  std::array<int, kRimSectors> sector_points{};
  int points = 0;
};

Sums accumulate(const RimTrace& trace, const Vector5& delta, double scale) {
  Sums s;
  for (const RimPoint& p : trace.points) {
    const Vector5 j = row(p);
    const double r = p.excess - j.dot(delta);
    const double u = r / (kTukey * scale), rest = 1 - u * u;
    if (rest <= 0) continue;
    const double w = rest * rest;
    for (int m = 0; m < 5; ++m) {
      const double wj = w * j[m];
      for (int n = 0; n <= m; ++n) s.a(m, n) += wj * j[n];
      s.b[m] += wj * p.excess;
    }
    s.w += w;
    s.psi_sq += w * r * w * r;
    s.psi_slope += rest * (1 - 5 * u * u);
    s.sector_psi[p.sector] += w * r;
    if (w > 0.5) {
      ++s.sector_points[p.sector];
      ++s.points;
    }
  }
  s.a.triangularView<Eigen::StrictlyUpper>() = s.a.transpose();
  return s;
}

// Variance of one point as the fit feels it: the M-estimator's, times what neighbours share. The
// latter from the sums over sectors: independent errors add up as roots, common ones do not.
double point_variance(const Sums& s, int parameters) {
  const double slope = std::max(s.psi_slope / s.w, 0.2);
  double between = 0;
  int used = 0;
  for (int b = 0; b < kRimSectors; ++b) {
    between += s.sector_psi[b] * s.sector_psi[b];
    used += s.sector_points[b] > 0;
  }
  const double freedom = static_cast<double>(used) / std::max(1, used - parameters);
  const double shared = std::max(1.0, between * freedom / std::max(s.psi_sq, 1e-30));
  return shared * s.psi_sq / (s.w * slope * slope) + 1e-12;
}

Estimate estimate(const RimTrace& trace, const Rim& rim, const CirclePrior& prior, bool ellipse,
                  Vector5 delta, double scale, double shrink_px) {
  thread_local std::vector<float> scratch;  // memory only
  Estimate result;
  const int parameters = ellipse ? 5 : 3;
  for (int pass = 0; pass < 12; ++pass) {
    const Sums s = accumulate(trace, delta, scale);
    if (s.points < 3 * parameters) return result;
    const double variance = point_variance(s, parameters);
    const Knowledge known = knowledge(rim, delta, prior, ellipse, shrink_px);
    const Matrix5 information = s.a / variance + known.precision;
    const Eigen::LDLT<Matrix5> solver(information);
    const Vector5 next = solver.solve(s.b / variance + known.pull);
    const double moved = (next - delta).cwiseAbs().maxCoeff();
    delta = next;
    const double now = std::clamp(robust_scale(trace.points, delta, scratch), 0.002, kWidest_px);
    const bool settled = pass > 1 && moved < 2e-4 && std::abs(now - scale) < 0.05 * scale;
    scale = std::max(now, 0.5 * scale);
    if (!settled && pass < 11) continue;
    result.ok = delta.allFinite();
    result.delta = delta;
    result.covariance = solver.solve(Matrix5::Identity());
    result.scale = now;
    result.points = s.points;
    for (int count : s.sector_points) result.arc += count > 0 ? 1.0 / kRimSectors : 0;
    break;
  }
  return result;
}

// Are e1 and e2 more than noise? Wald's test; needs rim on most sides to tell shape from place.
bool significant(const Rim& rim, const Estimate& fit) {
  const Eigen::Vector2d e{rim.e1 + fit.delta[3], rim.e2 + fit.delta[4]};
  const Eigen::Matrix2d covariance = fit.covariance.bottomRightCorner<2, 2>();
  return e.dot(covariance.ldlt().solve(e)) > kSignificant;
}

}  // namespace

RimFit fit_rim(const RimTrace& trace, const Rim& rim, const CirclePrior& prior,
               bool allow_ellipse) {
  RimFit fit;
  fit.rim = rim;
  if (trace.points.size() < 15) return fit;
  const double shrink = trace.edge_sigma_px * trace.edge_sigma_px / (2 * rim.r);
  Estimate best;
  if (allow_ellipse) {
    best = estimate(trace, rim, prior, true, Vector5::Zero(), kWidest_px, shrink);
    fit.ellipse = best.ok && significant(rim, best);
  }
  if (!fit.ellipse) {
    best = estimate(trace, rim, prior, false, best.delta, kWidest_px, shrink);
  }
  if (!best.ok) return fit;
  fit.ok = true;
  fit.rim = {rim.cx + best.delta[0], rim.cy + best.delta[1], rim.r + best.delta[2],
             fit.ellipse ? rim.e1 + best.delta[3] : 0, fit.ellipse ? rim.e2 + best.delta[4] : 0};
  for (int i = 0; i < 5; ++i) fit.sd[i] = std::sqrt(std::max(0.0, best.covariance(i, i)));
  fit.residual_px = best.scale;
  fit.points = best.points;
  fit.arc = best.arc;
  return fit;
}

}  // namespace impactdic
