#include "host/dic/reference/ball.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "host/base/statistics.h"
#include "host/dic/frames/bspline.h"
#include "host/dic/frames/spline_taps.h"
#include "host/dic/reference/sphere.h"

namespace impactdic::dic {
namespace {

using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

// The pixels of the disc, one a row: where they are from the centre, grey level and slopes.
struct Disc {
  std::vector<Vector2d> at;
  std::vector<BSplineImage::Sample> sample;
};

Disc cut_disc(const BSplineImage& picture, const Vector2d& centre, double radius) {
  Disc disc;
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const Vector2d from = Vector2d(x, y) - centre;
      if (from.squaredNorm() >= radius * radius) continue;
      disc.at.push_back(from);
      disc.sample.push_back(picture.sample(x, y));
    }
  }
  return disc;
}

class BallLoop {
 public:
  BallLoop(const BSplineImage& first, const BSplineImage& second, const BallTask& task,
           const BallOptions& options, double grey_level)
      : second_(second),
        options_(options),
        centre_(task.cx, task.cy),
        disc_(cut_disc(first, centre_, task.radius)),
        radius_(task.radius),
        smallest_scale_(grey_level) {
    const double c = std::cos(task.guess_rot_rad), s = std::sin(task.guess_rot_rad);
    a_ << c, s, -s, c;
    t_ << task.guess_dx, task.guess_dy;
  }

  // Steps of Gauss and Newton until they vanish. False where the regression is singular.
  bool run() {
    double moved = 1;
    for (int k = 0; k < 100; ++k) {
      if (!step(moved)) return false;
      ++steps_;
      if (moved < 1e-9 && (!options_.robust || scale_ > 0)) return true;
    }
    // The scale may chatter between two pixels' residuals.
    return moved < 1e-6;
  }

  const Matrix2d& a() const { return a_; }
  const Vector2d& t() const { return t_; }
  double correlation() const { return correlation_; }
  double variance() const { return variance_; }
  double carried() const { return carried_; }
  int steps() const { return steps_; }

 private:
  static constexpr Eigen::Index kLight = 4;
  bool is_affine() const { return options_.model == BallModel::kAffine; }
  Eigen::Index columns() const { return kLight + (is_affine() ? 6 : 3); }

  VectorXd regressors(std::size_t k) const {
    const auto& s = disc_.sample[k];
    const Vector2d& p = disc_.at[k];
    VectorXd row(columns());
    const double along_x = s.value * p.x() / radius_, along_y = s.value * p.y() / radius_;
    if (is_affine()) {
      row << 1, s.value, along_x, along_y, s.slope_x, s.slope_x * p.x(), s.slope_x * p.y(),
          s.slope_y, s.slope_y * p.x(), s.slope_y * p.y();
    } else {
      row << 1, s.value, along_x, along_y, s.slope_x, s.slope_y,
          s.slope_x * p.y() - s.slope_y * p.x();
    }
    return row;
  }

  // Solves g∘W ≈ light · (1, f, f X/R, f Y/R) + gain J δ with the weights of the step before and
  // composes.
  bool step(double& moved) {
    MatrixXd normal = MatrixXd::Zero(columns(), columns());
    VectorXd right = VectorXd::Zero(columns());
    std::vector<double> sizes;
    double gg = 0, g_sum = 0;
    for (std::size_t k = 0; k < disc_.at.size(); ++k) {
      const Vector2d p = centre_ + t_ + a_ * disc_.at[k];
      if (!(p.x() >= 0 && p.y() >= 0 && p.x() <= second_.width() - 1 &&
            p.y() <= second_.height() - 1)) {
        continue;
      }
      const double g = second_.value(p.x(), p.y());
      const VectorXd row = regressors(k);
      const double r = g - light_.dot(row.head<kLight>());
      sizes.push_back(std::abs(r));
      double w = 1;
      if (scale_ > 0) w = std::pow(std::max(0.0, 1 - std::pow(r / (6 * scale_), 2)), 2);
      normal += w * row * row.transpose();
      right += w * g * row;
      g_sum += w * g;
      gg += w * g * g;
    }
    const Eigen::LDLT<MatrixXd> solver(normal);
    const VectorXd solution = solver.solve(right);
    carried_ = normal(0, 0);
    const double f_mean = normal(0, 1) / carried_, g_mean = g_sum / carried_;
    const double ff = normal(1, 1) - carried_ * f_mean * f_mean;
    correlation_ =
        (right(1) - carried_ * f_mean * g_mean) / std::sqrt(ff * (gg - carried_ * g_mean * g_mean));
    variance_ = (gg - solution.dot(right)) / (carried_ - static_cast<double>(columns()));
    light_ = solution.head<kLight>();
    if (!(light_(1) > 0) || !(solver.vectorD().minCoeff() > 0)) return false;
    moved = compose(solution.tail(columns() - kLight) / light_(1));
    if (options_.robust && moved < 0.5) {
      scale_ = std::max(kSdOfMad * upper_median(std::move(sizes)), smallest_scale_);
    }
    return true;
  }

  double compose(const VectorXd& delta) {
    Matrix2d d;
    Vector2d shift;
    if (is_affine()) {
      d << 1 + delta(1), delta(2), delta(4), 1 + delta(5);
      shift << delta(0), delta(3);
    } else {
      const double c = std::cos(delta(2)), s = std::sin(delta(2));
      d << c, s, -s, c;
      shift << delta(0), delta(1);
    }
    a_ = a_ * d.inverse();
    t_ -= a_ * shift;
    return shift.norm() + radius_ * (d - Matrix2d::Identity()).norm();
  }

  const BSplineImage& second_;
  const BallOptions& options_;
  Vector2d centre_;
  Disc disc_;
  double radius_, smallest_scale_;
  Matrix2d a_;
  Vector2d t_;
  Eigen::Vector4d light_ = {0, 1, 0, 0};
  double scale_ = 0;
  double correlation_ = 0, variance_ = 0, carried_ = 0;
  int steps_ = 0;
};

}  // namespace

BallMotion ball_reference(const Frame& first, const Frame& second, const BallTask& task,
                          const BallOptions& options) {
  options.validate();
  if (options.model == BallModel::kSphereAndRadius ||
      options.model == BallModel::kSphereRadiusAndDistance) {
    throw InvalidArgument("the reference knows its sphere's radius and distance");
  }
  if (options.model == BallModel::kSphere) return sphere_reference(first, second, task, options);
  const bool affine = options.model == BallModel::kAffine;
  const BSplineImage f(to_double(first), options.spline_degree, options.presmooth_sigma_px);
  const BSplineImage g(to_double(second), options.spline_degree, options.presmooth_sigma_px);
  BallLoop registration(f, g, task, options, first.full_scale() / 255);
  BallMotion motion{};
  const float nan = std::numeric_limits<float>::quiet_NaN();
  if (!registration.run()) {
    motion.status = static_cast<idic_int>(WindowStatus::kNotConverged);
    motion.dx = motion.dy = motion.rot_rad = nan;
    return motion;
  }
  const Matrix2d& a = registration.a();
  const double turn = std::atan2(a(0, 1) - a(1, 0), a(0, 0) + a(1, 1));
  const double c = std::cos(turn), s = std::sin(turn);
  const Matrix2d stretch = (Matrix2d() << c, -s, s, c).finished() * a;
  motion.dx = static_cast<float>(registration.t().x());
  motion.dy = static_cast<float>(registration.t().y());
  motion.rot_rad = static_cast<float>(turn);
  motion.exx = affine ? static_cast<float>(stretch(0, 0) - 1) : 0;
  motion.exy = affine ? static_cast<float>((stretch(0, 1) + stretch(1, 0)) / 2) : 0;
  motion.eyy = affine ? static_cast<float>(stretch(1, 1) - 1) : 0;
  motion.correlation = static_cast<float>(registration.correlation());
  motion.residual = static_cast<float>(std::sqrt(registration.variance()));
  motion.used =
      static_cast<float>(registration.carried() / (std::numbers::pi * task.radius * task.radius));
  motion.steps = registration.steps();
  return motion;
}

}  // namespace impactdic::dic
