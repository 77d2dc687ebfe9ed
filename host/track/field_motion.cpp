#include "host/track/field_motion.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

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

// Weighted least squares of u and v on (1, x, y); returns the value at the origin.
struct LocalFit {
  Eigen::Matrix<double, 3, 2> coefficients;
  Eigen::Matrix3d inverse;
  bool ok;
};

LocalFit fit_plane(const std::vector<PointMotion>& near, const std::vector<double>& weights,
                   double cx, double cy) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
  for (std::size_t i = 0; i < near.size(); ++i) {
    const Eigen::Vector3d row(1, near[i].x_px - cx, near[i].y_px - cy);
    normal += weights[i] * row * row.transpose();
    right += weights[i] * row * Eigen::RowVector2d(near[i].u_px, near[i].v_px);
  }
  const Eigen::FullPivLU<Eigen::Matrix3d> lu(normal);
  if (!lu.isInvertible()) return {{}, {}, false};
  return {lu.solve(right), lu.inverse(), true};
}

}  // namespace

CentreMotion interpolate_at(std::span<const PointMotion> points, double cx_px, double cy_px) {
  constexpr std::size_t kNeighbours = 25, kFewest = 4;
  constexpr int kRobustRounds = 4;
  if (points.size() < kFewest) return {};
  std::vector<PointMotion> near(points.begin(), points.end());
  const auto distance = [&](const PointMotion& p) {
    return std::hypot(p.x_px - cx_px, p.y_px - cy_px);
  };
  std::sort(near.begin(), near.end(),
            [&](const PointMotion& a, const PointMotion& b) { return distance(a) < distance(b); });
  const double reach = 1.001 * distance(near[std::min(kNeighbours, near.size()) - 1]) + 1e-9;
  near.resize(std::min(kNeighbours, near.size()));
  std::vector<double> base(near.size());
  for (std::size_t i = 0; i < near.size(); ++i) {
    const double t = distance(near[i]) / reach;
    base[i] = std::pow(1 - t * t * t, 3) / (near[i].sd_px * near[i].sd_px);
  }
  std::vector<double> weights = base;
  LocalFit fit{};
  double scatter = 0;
  for (int round = 0; round < kRobustRounds; ++round) {
    fit = fit_plane(near, weights, cx_px, cy_px);
    if (!fit.ok) return {};
    std::vector<double> residuals(near.size());
    for (std::size_t i = 0; i < near.size(); ++i) {
      const Eigen::RowVector3d row(1, near[i].x_px - cx_px, near[i].y_px - cy_px);
      const Eigen::RowVector2d model = row * fit.coefficients;
      residuals[i] = std::hypot(near[i].u_px - model(0), near[i].v_px - model(1));
    }
    std::vector<double> sorted = residuals;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<long>(sorted.size() / 2),
                     sorted.end());
    scatter = std::max(sorted[sorted.size() / 2] / kRayleighMedian, 1e-6);
    for (std::size_t i = 0; i < near.size(); ++i) {
      const double t = residuals[i] / (6 * scatter);
      weights[i] = t < 1 ? base[i] * (1 - t * t) * (1 - t * t) : 0;
    }
  }
  // Sandwich variance of the intercept for residuals of size `scatter`.
  double variance = 0;
  for (std::size_t i = 0; i < near.size(); ++i) {
    const Eigen::Vector3d row(1, near[i].x_px - cx_px, near[i].y_px - cy_px);
    const double influence = (fit.inverse.row(0) * row)(0) * weights[i];
    variance += influence * influence * scatter * scatter;
  }
  return {true, fit.coefficients(0, 0), fit.coefficients(0, 1), std::sqrt(variance),
          std::sqrt(variance)};
}

FieldStrain fit_strain(std::span<const PointMotion> points) {
  constexpr std::size_t kFewest = 12;
  constexpr int kRounds = 6;
  if (points.size() < kFewest) return {};
  const std::vector<PointMotion> all(points.begin(), points.end());
  double cx = 0, cy = 0;
  for (const PointMotion& p : all) {
    cx += p.x_px / static_cast<double>(all.size());
    cy += p.y_px / static_cast<double>(all.size());
  }
  std::vector<double> weights(all.size(), 1), lengths(all.size()), sorted;
  LocalFit fit{};
  double scatter = 0;
  for (int round = 0; round < kRounds; ++round) {
    fit = fit_plane(all, weights, cx, cy);
    if (!fit.ok) return {};
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Eigen::RowVector3d row(1, all[i].x_px - cx, all[i].y_px - cy);
      const Eigen::RowVector2d model = row * fit.coefficients;
      lengths[i] = std::hypot(all[i].u_px - model(0), all[i].v_px - model(1));
    }
    sorted = lengths;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    scatter = std::max(*middle / kRayleighMedian, 1e-6);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double t = lengths[i] / (6 * scatter);
      weights[i] = t < 1 ? (1 - t * t) * (1 - t * t) : 0;
    }
  }
  Eigen::Matrix2d stretch = fit.coefficients.bottomRows<2>().transpose();
  stretch += Eigen::Matrix2d::Identity();
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
