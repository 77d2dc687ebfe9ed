// Measured displacements as columns, and affine motions fitted to them by weighted least squares:
// what the robust fits repeat in every round, several points at once. Internal.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <span>
#include <utility>

#include "host/base/order_statistic.h"
#include "host/dic/rigid_fit.h"

namespace impactdic {

// Points about an origin and their displacements, px.
struct PointColumns {
  using ArrayXd = Eigen::ArrayXd;
  ArrayXd x, y, u, v;
  ArrayXd per_variance;  // 1 / sd²

  PointColumns(std::span<const PointMotion> points, double cx_px, double cy_px) {
    const auto count = static_cast<Eigen::Index>(points.size());
    for (ArrayXd* column : {&x, &y, &u, &v, &per_variance}) column->resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const PointMotion& p = points[static_cast<std::size_t>(i)];
      x[i] = p.x_px - cx_px;
      y[i] = p.y_px - cy_px;
      u[i] = p.u_px;
      v[i] = p.v_px;
      per_variance[i] = 1 / (p.sd_px * p.sd_px);
    }
  }
  // Those that `indices` name.
  template <typename Indices>
  PointColumns of(const Indices& indices) const {
    return {x(indices), y(indices), u(indices), v(indices), per_variance(indices)};
  }
  Eigen::Index size() const { return x.size(); }

 private:
  PointColumns(ArrayXd x_, ArrayXd y_, ArrayXd u_, ArrayXd v_, ArrayXd per_variance_)
      : x(std::move(x_)),
        y(std::move(y_)),
        u(std::move(u_)),
        v(std::move(v_)),
        per_variance(std::move(per_variance_)) {}
};

// The displacement of (x, y) is (u + ux x + uy y, v + vx x + vy y).
struct AffineMotion {
  double u = 0, v = 0, ux = 0, uy = 0, vx = 0, vy = 0;

  double gradient_distance(const AffineMotion& other) const {
    return std::hypot(std::hypot(ux - other.ux, uy - other.uy),
                      std::hypot(vx - other.vx, vy - other.vy));
  }
  // Squared distances of the measured displacements from those of this motion.
  Eigen::ArrayXd residuals_sq(const PointColumns& points) const {
    return (points.u - (u + ux * points.x + uy * points.y)).square() +
           (points.v - (v + vx * points.x + vy * points.y)).square();
  }
};

inline double median(const Eigen::ArrayXd& values) {
  const Eigen::ArrayXf brief = values.cast<float>();
  return median(std::span(brief.data(), static_cast<std::size_t>(brief.size())));
}

// Tukey's biweight (Beaton and Tukey 1974) of squared residuals over the squared cut.
inline Eigen::ArrayXd biweight(const Eigen::ArrayXd& over_cut_sq) {
  return (1 - over_cut_sq).max(0.0).square();
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
};

// Weighted moments of points and displacements about their common centroid.
struct Moments {
  double weight = 0;
  double x = 0, y = 0, u = 0, v = 0;  // the centroid and its displacement
  double xx = 0, xy = 0, yy = 0;      // Σ w of the products
  double xu = 0, yu = 0, xv = 0, yv = 0;

  Moments(const PointColumns& p, const Eigen::ArrayXd& weights) {
    // In one look at the points, several at once.
    constexpr Eigen::Index kAtOnce = 4;
    using Lanes = Eigen::Array<double, kAtOnce, 1>;
    Sums<Lanes> lanes(Lanes::Zero());
    Eigen::Index i = 0;
    for (; i + kAtOnce <= p.size(); i += kAtOnce) {
      const auto of = [i](const Eigen::ArrayXd& column) -> Lanes {
        return column.segment<kAtOnce>(i);
      };
      lanes.add(of(weights), of(p.x), of(p.y), of(p.u), of(p.v));
    }
    Sums<double> sums(0);
    for (; i < p.size(); ++i) sums.add(weights[i], p.x[i], p.y[i], p.u[i], p.v[i]);
    const auto total = [](const Lanes& of_lanes, double rest) { return of_lanes.sum() + rest; };
    weight = total(lanes.w, sums.w);
    x = total(lanes.x, sums.x) / weight;
    y = total(lanes.y, sums.y) / weight;
    u = total(lanes.u, sums.u) / weight;
    v = total(lanes.v, sums.v) / weight;
    xx = total(lanes.xx, sums.xx) - weight * x * x;
    xy = total(lanes.xy, sums.xy) - weight * x * y;
    yy = total(lanes.yy, sums.yy) - weight * y * y;
    xu = total(lanes.xu, sums.xu) - weight * x * u;
    yu = total(lanes.yu, sums.yu) - weight * y * u;
    xv = total(lanes.xv, sums.xv) - weight * x * v;
    yv = total(lanes.yv, sums.yv) - weight * y * v;
  }

  double inertia() const { return xx + yy; }
  double determinant() const { return xx * yy - xy * xy; }
  // Whether the points lie on a line, as far as an affine motion is concerned.
  bool on_a_line() const { return !(4 * determinant() > 1e-6 * inertia() * inertia()); }

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
  Eigen::ArrayXd influence_at_origin(const PointColumns& p) const {
    const double per = 1 / determinant();
    const double of_x = per * (xy * y - yy * x), of_y = per * (xy * x - xx * y);
    return 1 / weight + of_x * (p.x - x) + of_y * (p.y - y);
  }
};

}  // namespace impactdic
