// Measured displacements as columns, and affine motions fitted to them by weighted least squares:
// what the robust fits repeat in every round, several points at once. Internal.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <span>

#include "host/base/statistics.h"
#include "host/dic/rigid_fit.h"

namespace impactdic::dic {

// The displacement of (x, y) is (u + ux x + uy y, v + vx x + vy y).
struct AffineMotion {
  double u = 0, v = 0, ux = 0, uy = 0, vx = 0, vy = 0;

  AffineMotion operator-(const AffineMotion& other) const {
    return {u - other.u, v - other.v, ux - other.ux, uy - other.uy, vx - other.vx, vy - other.vy};
  }
  double gradient_length() const { return std::hypot(std::hypot(ux, uy), std::hypot(vx, vy)); }
};

// Points and what `base` leaves of their displacements, px. Single precision: what is left is
// small, so that nothing that was measured is lost.
struct PointColumns {
  using ArrayXf = Eigen::ArrayXf;
  AffineMotion base;
  ArrayXf x, y, u, v;
  ArrayXf per_variance;  // 1 / sd²

  // Of `points`, or of every `stride`-th of them, about (cx, cy).
  PointColumns(std::span<const PointMotion> points, double cx_px, double cy_px,
               const AffineMotion& of_base = {}, std::size_t stride = 1)
      : base(of_base) {
    const auto count = static_cast<Eigen::Index>((points.size() + stride - 1) / stride);
    for (ArrayXf* column : {&x, &y, &u, &v, &per_variance}) column->resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const PointMotion& p = points[static_cast<std::size_t>(i) * stride];
      const double x_px = p.x_px - cx_px, y_px = p.y_px - cy_px;
      x[i] = static_cast<float>(x_px);
      y[i] = static_cast<float>(y_px);
      u[i] = static_cast<float>(p.u_px - (base.u + base.ux * x_px + base.uy * y_px));
      v[i] = static_cast<float>(p.v_px - (base.v + base.vx * x_px + base.vy * y_px));
      per_variance[i] = static_cast<float>(1 / (p.sd_px * p.sd_px));
    }
  }
  Eigen::Index size() const { return x.size(); }
  // Squared distances of the measured displacements from those of `motion`: an expression, to be
  // evaluated where it stands.
  auto residuals_sq(const AffineMotion& motion) const {
    const AffineMotion m = motion - base;
    const auto f = [](double value) { return static_cast<float>(value); };
    return (u - (f(m.u) + f(m.ux) * x + f(m.uy) * y)).square() +
           (v - (f(m.v) + f(m.vx) * x + f(m.vy) * y)).square();
  }
};

inline float upper_median(const Eigen::ArrayXf& values) {
  return impactdic::upper_median(std::span(values.data(), static_cast<std::size_t>(values.size())));
}

// Tukey's biweight (Beaton and Tukey 1974) of squared residuals over the squared cut: an
// expression, to be evaluated where it stands.
template <typename Squares>
auto biweight(const Squares& over_cut_sq) {
  return (1 - over_cut_sq).max(0.0F).square();
}

// Weighted sums of points and displacements and of their products.
template <typename T>
struct Sums {
  T w, x, y, u, v, xx, xy, yy, xu, yu, xv, yv;

  explicit Sums(const T& zero)
      : w(zero),
        x(zero),
        y(zero),
        u(zero),
        v(zero),
        xx(zero),
        xy(zero),
        yy(zero),
        xu(zero),
        yu(zero),
        xv(zero),
        yv(zero) {}
  void add(const T& w_, const T& x_, const T& y_, const T& u_, const T& v_) {
    const T wx = w_ * x_, wy = w_ * y_;
    w += w_;
    x += wx;
    y += wy;
    u += w_ * u_;
    v += w_ * v_;
    xx += wx * x_;
    xy += wx * y_;
    yy += wy * y_;
    xu += wx * u_;
    yu += wy * u_;
    xv += wx * v_;
    yv += wy * v_;
  }
  // Other sums, each as a number of this kind.
  template <typename Other, typename Total>
  void add(const Sums<Other>& other, const Total& total) {
    w += total(other.w);
    x += total(other.x);
    y += total(other.y);
    u += total(other.u);
    v += total(other.v);
    xx += total(other.xx);
    xy += total(other.xy);
    yy += total(other.yy);
    xu += total(other.xu);
    yu += total(other.yu);
    xv += total(other.xv);
    yv += total(other.yv);
  }
};

// Weighted moments of points and displacements about their common centroid.
struct Moments {
  double weight = 0;
  double x = 0, y = 0, u = 0, v = 0;  // the centroid and its displacement
  double xx = 0, xy = 0, yy = 0;      // Σ w of the products
  double xu = 0, yu = 0, xv = 0, yv = 0;

  // `base`: what the displacements in `sums` come on top of.
  Moments(const Sums<double>& sums, const AffineMotion& base)
      : weight(sums.w), x(sums.x / sums.w), y(sums.y / sums.w) {
    xx = sums.xx - weight * x * x;
    xy = sums.xy - weight * x * y;
    yy = sums.yy - weight * y * y;
    const double left_u = sums.u / weight, left_v = sums.v / weight;
    u = left_u + base.u + base.ux * x + base.uy * y;
    v = left_v + base.v + base.vx * x + base.vy * y;
    xu = sums.xu - weight * x * left_u + base.ux * xx + base.uy * xy;
    yu = sums.yu - weight * y * left_u + base.ux * xy + base.uy * yy;
    xv = sums.xv - weight * x * left_v + base.vx * xx + base.vy * xy;
    yv = sums.yv - weight * y * left_v + base.vx * xy + base.vy * yy;
  }
  Moments(const PointColumns& points, const Eigen::ArrayXf& weights)
      : Moments(sums_of(points, weights), points.base) {}

  double inertia() const { return xx + yy; }
  double determinant() const { return xx * yy - xy * xy; }
  // Whether all points are one, and whether they lie on a line, as far as single precision tells.
  bool at_a_point() const { return !(inertia() > 1e-6 * weight * (x * x + y * y)); }
  bool on_a_line() const {
    return at_a_point() || !(4 * determinant() > 1e-5 * inertia() * inertia());
  }

  // With the given gradient, through the centroid.
  AffineMotion motion(double ux, double uy, double vx, double vy) const {
    return {u - ux * x - uy * y, v - vx * x - vy * y, ux, uy, vx, vy};
  }
  // The rigid motion of least squares: weighted Procrustes (Arun, Huang and Blostein 1987).
  AffineMotion rigid() const {
    // The points' new places are their old ones and the displacements.
    const double along = inertia() + xu + yv, across = xv - yu;
    const double length = std::hypot(along, across);
    const double c = length > 0 ? along / length : 1, s = length > 0 ? across / length : 0;
    return motion(c - 1, -s, s, c - 1);
  }
  // The affine motion of least squares; not for points on a line.
  AffineMotion affine() const {
    const double per = 1 / determinant();
    return motion(per * (xu * yy - yu * xy), per * (yu * xx - xu * xy), per * (xv * yy - yv * xy),
                  per * (yv * xx - xv * xy));
  }
  // How much the displacement that `affine` finds at the origin changes with that of every point,
  // over its weight.
  Eigen::ArrayXf influence_at_origin(const PointColumns& p) const {
    const double per = 1 / determinant();
    const double of_x = per * (xy * y - yy * x), of_y = per * (xy * x - xx * y);
    const auto f = [](double value) { return static_cast<float>(value); };
    return f(1 / weight - of_x * x - of_y * y) + f(of_x) * p.x + f(of_y) * p.y;
  }

 private:
  // In one look at the points, several at once.
  static Sums<double> sums_of(const PointColumns& p, const Eigen::ArrayXf& weights) {
    constexpr Eigen::Index kAtOnce = 8;
    using Lanes = Eigen::Array<float, kAtOnce, 1>;
    Sums<Lanes> lanes(Lanes::Zero());
    Eigen::Index i = 0;
    for (; i + kAtOnce <= p.size(); i += kAtOnce) {
      const auto of = [i](const Eigen::ArrayXf& column) -> Lanes {
        return column.segment<kAtOnce>(i);
      };
      lanes.add(of(weights), of(p.x), of(p.y), of(p.u), of(p.v));
    }
    Sums<double> sums(0);
    for (; i < p.size(); ++i) sums.add(weights[i], p.x[i], p.y[i], p.u[i], p.v[i]);
    sums.add(lanes, [](const Lanes& of_lanes) -> double { return of_lanes.sum(); });
    return sums;
  }
};

}  // namespace impactdic::dic
