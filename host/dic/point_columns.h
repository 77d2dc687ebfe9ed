// Measured displacements as columns, and affine motions fitted to them by weighted least squares:
// what the robust fits repeat in every round. Internal; every sum is a pass that vectorises.
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
  Eigen::ArrayXd x, y, u, v;
  Eigen::ArrayXd per_variance;  // 1 / sd²

  PointColumns(std::span<const PointMotion> points, double cx_px, double cy_px) {
    const auto count = static_cast<Eigen::Index>(points.size());
    for (Eigen::ArrayXd* column : {&x, &y, &u, &v, &per_variance}) column->resize(count);
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

// Weighted moments of points and displacements about their common centroid.
struct Moments {
  double weight = 0;
  double x = 0, y = 0, u = 0, v = 0;  // the centroid and its displacement
  double xx = 0, xy = 0, yy = 0;      // Σ w of the products
  double xu = 0, yu = 0, xv = 0, yv = 0;

  Moments(const PointColumns& p, const Eigen::ArrayXd& weights) {
    const Eigen::ArrayXd wx = weights * p.x, wy = weights * p.y;
    weight = weights.sum();
    x = wx.sum() / weight;
    y = wy.sum() / weight;
    u = (weights * p.u).sum() / weight;
    v = (weights * p.v).sum() / weight;
    xx = (wx * p.x).sum() - weight * x * x;
    xy = (wx * p.y).sum() - weight * x * y;
    yy = (wy * p.y).sum() - weight * y * y;
    xu = (wx * p.u).sum() - weight * x * u;
    yu = (wy * p.u).sum() - weight * y * u;
    xv = (wx * p.v).sum() - weight * x * v;
    yv = (wy * p.v).sum() - weight * y * v;
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
