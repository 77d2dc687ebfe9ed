#include "host/track/field_motion.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

namespace impactdic {

void aim_windows(std::span<Window> windows, int window_px, int first_slot, int second_slot,
                 const MotionGuess& guess) {
  const double half = (window_px - 1) / 2.0;
  // Counter-clockwise on the screen, with y down.
  const double c = std::cos(guess.rot_rad) - 1, s = std::sin(guess.rot_rad);
  for (Window& window : windows) {
    const double x = window.x0 + half - guess.cx_px, y = window.y0 + half - guess.cy_px;
    window.first = first_slot;
    window.second = second_slot;
    window.guess_u = static_cast<idic_int>(std::lround(guess.dx_px + c * x + s * y));
    window.guess_v = static_cast<idic_int>(std::lround(guess.dy_px - s * x + c * y));
    window.guess_rot_rad = static_cast<float>(guess.rot_rad);
  }
}

std::vector<PointMotion> field_points(std::span<const Window> windows,
                                      std::span<const WindowMotion> motions, int window_px,
                                      double floor_px) {
  const double half = (window_px - 1) / 2.0;
  std::vector<PointMotion> points;
  points.reserve(windows.size());
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const WindowMotion& motion = motions[i];
    if (motion.status != static_cast<idic_int>(WindowStatus::ok)) continue;
    const double sd = std::sqrt(0.5 * (motion.u_sd * motion.u_sd + motion.v_sd * motion.v_sd));
    points.push_back({windows[i].x0 + half, windows[i].y0 + half, motion.u, motion.v,
                      std::isfinite(sd) ? std::max(sd, floor_px) : floor_px});
  }
  return points;
}

void account_for_overlap(RigidMotion& motion, int window_px, int spacing_px) {
  const double wider = std::max(1.0, static_cast<double>(window_px) / spacing_px);
  motion.dx_sd_px *= wider;
  motion.dy_sd_px *= wider;
  motion.rot_sd_rad *= wider;
}

namespace {

// Median length of a two-dimensional normal vector of unit scatter.
constexpr double kRayleighMedian = 1.1774;

// Weighted least squares of u and v on (1, x, y) about (cx, cy).
struct PlaneFit {
  bool ok = false;
  double u[3] = {}, v[3] = {};  // coefficients
  Eigen::Matrix3d inverse;      // of the normal matrix

  double residual_sq(const PointMotion& p, double cx, double cy) const {
    const double x = p.x_px - cx, y = p.y_px - cy;
    const double du = p.u_px - (u[0] + u[1] * x + u[2] * y);
    const double dv = p.v_px - (v[0] + v[1] * x + v[2] * y);
    return du * du + dv * dv;
  }
};

PlaneFit fit_plane(std::span<const PointMotion> points, std::span<const double> weights, double cx,
                   double cy) {
  double s = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0;
  double u = 0, ux = 0, uy = 0, v = 0, vx = 0, vy = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const PointMotion& p = points[i];
    const double x = p.x_px - cx, y = p.y_px - cy, w = weights[i], wx = w * x, wy = w * y;
    s += w;
    sx += wx;
    sy += wy;
    sxx += wx * x;
    sxy += wx * y;
    syy += wy * y;
    u += w * p.u_px;
    ux += wx * p.u_px;
    uy += wy * p.u_px;
    v += w * p.v_px;
    vx += wx * p.v_px;
    vy += wy * p.v_px;
  }
  Eigen::Matrix3d normal;
  normal << s, sx, sy, sx, sxx, sxy, sy, sxy, syy;
  const Eigen::FullPivLU<Eigen::Matrix3d> lu(normal);
  PlaneFit fit;
  fit.ok = lu.isInvertible();
  if (!fit.ok) return fit;
  fit.inverse = lu.inverse();
  const Eigen::Vector3d of_u = lu.solve(Eigen::Vector3d(u, ux, uy));
  const Eigen::Vector3d of_v = lu.solve(Eigen::Vector3d(v, vx, vy));
  std::copy_n(of_u.data(), 3, fit.u);
  std::copy_n(of_v.data(), 3, fit.v);
  return fit;
}

// Median of squared lengths as the scatter of one component; `scratch` is overwritten.
double scatter_of(std::span<const double> squares, std::vector<double>& scratch) {
  scratch.assign(squares.begin(), squares.end());
  const auto middle = scratch.begin() + static_cast<std::ptrdiff_t>(scratch.size() / 2);
  std::nth_element(scratch.begin(), middle, scratch.end());
  return std::max(std::sqrt(*middle) / kRayleighMedian, 1e-6);
}

// Tukey's weight of a squared residual, cut off at six times the scatter.
double robust_weight(double squared, double scatter) {
  const double t_sq = squared / (36 * scatter * scatter);
  return t_sq < 1 ? (1 - t_sq) * (1 - t_sq) : 0;
}

// The `count` points nearest to (cx, cy), nearest first.
std::vector<PointMotion> nearest(std::span<const PointMotion> points, std::size_t count, double cx,
                                 double cy) {
  std::vector<std::pair<double, std::size_t>> order;
  order.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double x = points[i].x_px - cx, y = points[i].y_px - cy;
    order.emplace_back(x * x + y * y, i);
  }
  count = std::min(count, order.size());
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end());
  std::vector<PointMotion> near;
  for (std::size_t k = 0; k < count; ++k) near.push_back(points[order[k].second]);
  return near;
}

}  // namespace

CentreMotion interpolate_at(std::span<const PointMotion> points, double cx_px, double cy_px) {
  constexpr std::size_t kNeighbours = 25, kFewest = 4;
  constexpr int kRobustRounds = 4;
  if (points.size() < kFewest) return {};
  const std::vector<PointMotion> near = nearest(points, kNeighbours, cx_px, cy_px);
  const auto distance = [&](const PointMotion& p) {
    return std::hypot(p.x_px - cx_px, p.y_px - cy_px);
  };
  const double reach = 1.001 * distance(near.back()) + 1e-9;
  std::vector<double> base(near.size()), squares(near.size()), scratch;
  for (std::size_t i = 0; i < near.size(); ++i) {
    const double t = distance(near[i]) / reach, tricube = 1 - t * t * t;
    base[i] = tricube * tricube * tricube / (near[i].sd_px * near[i].sd_px);
  }
  std::vector<double> weights = base;
  PlaneFit fit;
  double scatter = 0;
  for (int round = 0; round < kRobustRounds; ++round) {
    fit = fit_plane(near, weights, cx_px, cy_px);
    if (!fit.ok) return {};
    for (std::size_t i = 0; i < near.size(); ++i) {
      squares[i] = fit.residual_sq(near[i], cx_px, cy_px);
    }
    scatter = scatter_of(squares, scratch);
    for (std::size_t i = 0; i < near.size(); ++i) {
      weights[i] = base[i] * robust_weight(squares[i], scatter);
    }
  }
  // Sandwich variance of the intercept for residuals of size `scatter`.
  double variance = 0;
  for (std::size_t i = 0; i < near.size(); ++i) {
    const Eigen::Vector3d row(1, near[i].x_px - cx_px, near[i].y_px - cy_px);
    const double influence = (fit.inverse.row(0) * row)(0) * weights[i];
    variance += influence * influence * scatter * scatter;
  }
  return {true, fit.u[0], fit.v[0], std::sqrt(variance), std::sqrt(variance)};
}

FieldStrain fit_strain(std::span<const PointMotion> points) {
  constexpr std::size_t kFewest = 12;
  constexpr int kRounds = 6;
  if (points.size() < kFewest) return {};
  double cx = 0, cy = 0;
  for (const PointMotion& p : points) {
    cx += p.x_px / static_cast<double>(points.size());
    cy += p.y_px / static_cast<double>(points.size());
  }
  std::vector<double> weights(points.size(), 1), squares(points.size()), scratch;
  PlaneFit fit;
  double scatter = 0;
  for (int round = 0; round < kRounds; ++round) {
    fit = fit_plane(points, weights, cx, cy);
    if (!fit.ok) return {};
    for (std::size_t i = 0; i < points.size(); ++i) {
      squares[i] = fit.residual_sq(points[i], cx, cy);
    }
    scatter = scatter_of(squares, scratch);
    for (std::size_t i = 0; i < points.size(); ++i) {
      weights[i] = robust_weight(squares[i], scatter);
    }
  }
  Eigen::Matrix2d stretch;
  stretch << 1 + fit.u[1], fit.u[2], fit.v[1], 1 + fit.v[2];
  const Eigen::Matrix2d green = 0.5 * (stretch.transpose() * stretch - Eigen::Matrix2d::Identity());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(green);
  return {true, solver.eigenvalues().cwiseAbs().maxCoeff(),
          scatter * std::sqrt(std::max(fit.inverse(1, 1), fit.inverse(2, 2)))};
}

double agreeing_share(const RigidMotion& motion, std::span<const WindowMotion> motions) {
  const auto could = std::count_if(motions.begin(), motions.end(), [](const WindowMotion& m) {
    const auto status = static_cast<WindowStatus>(m.status);
    return status != WindowStatus::no_texture && status != WindowStatus::out_of_view;
  });
  return could > 0 ? static_cast<double>(motion.used) / static_cast<double>(could) : 0;
}

TrackStatus explain_failure(std::span<const WindowMotion> motions) {
  std::size_t bare = 0, outside = 0;
  for (const WindowMotion& motion : motions) {
    bare += motion.status == static_cast<idic_int>(WindowStatus::no_texture);
    outside += motion.status == static_cast<idic_int>(WindowStatus::out_of_view);
  }
  if (outside * 2 > motions.size()) return TrackStatus::out_of_view;
  return bare * 2 >= motions.size() ? TrackStatus::no_texture : TrackStatus::low_correlation;
}

}  // namespace impactdic
