#include "host/dic/sphere/sphere_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "host/base/statistics.h"
#include "host/dic/sphere/rotation.h"

namespace impactdic::dic {
namespace {

constexpr int kSphereRounds = 20;
constexpr std::size_t kFewest = 8;
constexpr double kPointTukey = 6, kLeastScale_px = 0.03, kSettled_px = 1e-4;
// Points whose surface is seen more from the side tell little.
constexpr double kLeastPointDepth = 0.2;

using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

// Points on the sphere as columns, so that several are handled at once; camera axes, px. Sums go
// point by point all the same: their bits do not depend on how many that are.
struct LiftedPoints {
  Eigen::ArrayXd x, y, z;            // in the first picture
  Eigen::ArrayXd u, v;               // measured displacement
  Eigen::ArrayXd to_x, to_y, to_z;   // turned
  Eigen::ArrayXd off_x, off_y, off;  // measured less expected displacement, and its length
  Eigen::ArrayXd weight;
  std::vector<float> rough;  // lengths, to find their median

  LiftedPoints(std::span<const PointMotion> points, const SphereGuess& guess) {
    const auto most = static_cast<Eigen::Index>(points.size());
    for (Eigen::ArrayXd* column : {&x, &y, &z, &u, &v}) column->resize(most);
    Eigen::Index n = 0;
    for (const PointMotion& p : points) {
      const double px = p.x_px - guess.cx_px, py = -(p.y_px - guess.cy_px);
      const double square = guess.radius_px * guess.radius_px - px * px - py * py;
      if (square < std::pow(kLeastPointDepth * guess.radius_px, 2)) continue;
      x[n] = px;
      y[n] = py;
      z[n] = std::sqrt(square);
      u[n] = p.u_px;
      v[n] = -p.v_px;
      ++n;
    }
    for (Eigen::ArrayXd* column : {&x, &y, &z, &u, &v}) column->conservativeResize(n);
    rough.resize(static_cast<std::size_t>(n));
  }
  std::size_t size() const { return rough.size(); }

  void move(const SphereFit& fit) {
    // As Eigen turns a vector by a quaternion, in the same order.
    const double qw = fit.turn.w(), qx = fit.turn.x(), qy = fit.turn.y(), qz = fit.turn.z();
    const Eigen::ArrayXd by_x = 2 * (qy * z - qz * y), by_y = 2 * (qz * x - qx * z),
                         by_z = 2 * (qx * y - qy * x);
    to_x = x + qw * by_x + (qy * by_z - qz * by_y);
    to_y = y + qw * by_y + (qz * by_x - qx * by_z);
    to_z = z + qw * by_z + (qx * by_y - qy * by_x);
    off_x = u - fit.dx_px - (to_x - x);
    off_y = v + fit.dy_px - (to_y - y);
    off = (off_x.square() + off_y.square()).sqrt();
  }
  // The upper median of `off`, by that of the same numbers in single precision.
  double median_off() {
    for (std::size_t i = 0; i < rough.size(); ++i) {
      rough[i] = static_cast<float>(off[static_cast<Eigen::Index>(i)]);
    }
    const float middle = upper_median(std::span<const float>(rough));
    std::size_t below = 0;
    std::vector<double> about;
    for (std::size_t i = 0; i < rough.size(); ++i) {
      below += rough[i] < middle ? 1 : 0;
      if (rough[i] == middle) about.push_back(off[static_cast<Eigen::Index>(i)]);
    }
    return ranked(std::move(about), rough.size() / 2 - below);
  }
  // By Tukey's weights; returns how many have one.
  int weigh(double scale) {
    const double cut = kPointTukey * scale, variance = scale * scale;
    const Eigen::ArrayXd share = off / cut, rest = 1 - share.square();
    weight = (share >= 1).select(0.0, rest.square() / variance);
    return static_cast<int>(size()) - static_cast<int>((share >= 1).count());
  }
  // Of shifts, and turns after the guess about the camera's axes.
  void add_to(Matrix5& normal, Vector5& right) const {
    double w = 0, wx = 0, wy = 0, wz = 0, wzz = 0, wyz = 0, wxz = 0, wxy = 0;
    double to[5] = {};
    for (Eigen::Index i = 0; i < weight.size(); ++i) {
      const double each = weight[i], qx = to_x[i], qy = to_y[i], qz = to_z[i];
      const double rx = off_x[i], ry = off_y[i];
      w += each;
      wx += each * qx;
      wy += each * qy;
      wz += each * qz;
      wzz += each * (qz * qz);
      wyz += each * (qy * qz);
      wxz += each * (qx * qz);
      wxy += each * (qy * qy + qx * qx);
      to[0] += each * rx;
      to[1] += each * ry;
      to[2] += each * (-qz * ry);
      to[3] += each * (qz * rx);
      to[4] += each * (qx * ry - qy * rx);
    }
    normal << w, 0, 0, wz, -wy,  //
        0, w, -wz, 0, wx,        //
        0, -wz, wzz, 0, -wxz,    //
        wz, 0, 0, wzz, -wyz,     //
        -wy, wx, -wxz, -wyz, wxy;
    right << to[0], to[1], to[2], to[3], to[4];
  }
};

}  // namespace

bool carry(const SphereGuess& motion, double x_px, double y_px, double& to_x_px, double& to_y_px) {
  const double x = x_px - motion.cx_px, y = -(y_px - motion.cy_px);
  const double square = motion.radius_px * motion.radius_px - x * x - y * y;
  if (!(square > 0)) return false;
  const Eigen::Vector3d to = motion.turn * Eigen::Vector3d(x, y, std::sqrt(square));
  to_x_px = motion.cx_px + motion.dx_px + to.x();
  to_y_px = motion.cy_px + motion.dy_px - to.y();
  return to.z() > kLeastPointDepth * motion.radius_px;
}

SphereFit fit_sphere_motion(std::span<const PointMotion> points, const SphereGuess& guess) {
  SphereFit fit;
  fit.dx_px = guess.dx_px;
  fit.dy_px = guess.dy_px;
  fit.turn = guess.turn;
  LiftedPoints lifted(points, guess);
  if (lifted.size() < kFewest) return fit;
  for (int round = 0; round < kSphereRounds; ++round) {
    lifted.move(fit);
    // The median length of a normal deviate in the plane is 1.18 deviations.
    const double scale = std::max(lifted.median_off() / 1.18, kLeastScale_px);
    fit.used = lifted.weigh(scale);
    Matrix5 normal;
    Vector5 right;
    lifted.add_to(normal, right);
    const double by_guess = 1 / (guess.shift_sd_px * guess.shift_sd_px);
    normal(0, 0) += by_guess, normal(1, 1) += by_guess;
    right(0) += by_guess * (guess.dx_px - fit.dx_px);
    right(1) -= by_guess * (guess.dy_px - fit.dy_px);
    const Eigen::LDLT<Matrix5> solver(normal);
    if (solver.info() != Eigen::Success) return fit;
    const Vector5 step = solver.solve(right);
    if (!step.allFinite()) return fit;
    fit.dx_px += step(0);
    fit.dy_px -= step(1);
    fit.turn = (quaternion_of(step.tail<3>()) * fit.turn).normalized();
    fit.residual_px = scale;
    const Matrix5 covariance = solver.solve(Matrix5::Identity());
    fit.rot_x_sd_rad = std::sqrt(covariance(2, 2));
    fit.rot_y_sd_rad = std::sqrt(covariance(3, 3));
    const double moved = step.head<2>().norm() + guess.radius_px * step.tail<3>().norm();
    if (moved < kSettled_px) break;
  }
  fit.share = static_cast<double>(fit.used) / static_cast<double>(lifted.size());
  fit.ok = static_cast<std::size_t>(fit.used) >= kFewest;
  return fit;
}

}  // namespace impactdic::dic
