#include "host/dic/icgn_reference.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <optional>

#include "host/base/error.h"
#include "host/dic/spline_taps.h"

namespace impactdic {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Row = Eigen::Matrix<double, 1, 6>;

// The pixels of a window that carry weight: where they are from its centre, grey level and the
// derivatives by du, ux, uy, dv, vx, vy.
struct Template {
  Eigen::Matrix<double, Eigen::Dynamic, 2> at;
  Eigen::VectorXd f;
  Eigen::Matrix<double, Eigen::Dynamic, 6> jacobian;
};

struct Warp {
  Matrix2d a;
  Vector2d t;
};

// The part of every column of `m` that offset and gain of f cannot explain.
template <typename Matrix>
void project_out(const Eigen::VectorXd& f_unit, Matrix& m) {
  for (Eigen::Index k = 0; k < m.cols(); ++k) {
    m.col(k).array() -= m.col(k).mean();
    m.col(k) -= f_unit * f_unit.dot(m.col(k));
  }
}

double centred_norm(const Eigen::VectorXd& v) { return (v.array() - v.mean()).matrix().norm(); }

WindowMotion failed(WindowMotion motion, WindowStatus status) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  motion.u = motion.v = motion.u_sd = motion.v_sd = nan;
  motion.ux = motion.uy = motion.vx = motion.vy = nan;
  motion.status = static_cast<idic_int>(status);
  return motion;
}

bool inside(const BSplineImage& picture, const Vector2d& p) {
  return p.x() >= 0 && p.y() >= 0 && p.x() <= picture.width() - 1 && p.y() <= picture.height() - 1;
}

// False where a pixel of the warped window lies outside the picture.
bool in_view(const BSplineImage& picture, const Warp& warp, const Vector2d& centre, double half) {
  for (const double x : {-half, half}) {
    for (const double y : {-half, half}) {
      if (!inside(picture, centre + warp.t + warp.a * Vector2d(x, y))) return false;
    }
  }
  return true;
}

// Mean over a 5 × 5 raster of the window of the spline's noise variance.
double noise_in_window(int degree, const Warp& warp, const Vector2d& centre, double half) {
  const auto noise = interpolation_noise(degree, 0);
  const auto gain = [&](double x) {
    const double c = std::cos(2 * std::numbers::pi * x);
    return noise[0] + noise[1] * c + noise[2] * c * c;
  };
  double sum = 0;
  for (int j = -2; j <= 2; ++j) {
    for (int i = -2; i <= 2; ++i) {
      const Vector2d p = centre + warp.t + warp.a * Vector2d(i * half / 2, j * half / 2);
      sum += gain(p.x()) * gain(p.y());
    }
  }
  return sum / 25;
}

}  // namespace

IcgnReference::IcgnReference(const FieldOptions& options, int slots)
    : options_(options), slots_(static_cast<std::size_t>(slots)) {
  check_spline(options.spline_degree, 0);
}

void IcgnReference::set_frame(int slot, const Frame& frame) {
  if (slot < 0 || slot >= static_cast<int>(slots_.size())) {
    throw InvalidArgument("no such frame slot");
  }
  slots_[static_cast<std::size_t>(slot)].spline =
      BSplineImage(to_double(frame), options_.spline_degree);
  slots_[static_cast<std::size_t>(slot)].full_scale = frame.full_scale();
}

void IcgnReference::set_disc(int index, double cx_px, double cy_px, double radius_px) {
  Slot& changed = slots_.at(static_cast<std::size_t>(index));
  changed.cx_px = cx_px;
  changed.cy_px = cy_px;
  changed.radius_px = radius_px;
}

const IcgnReference::Slot& IcgnReference::slot(int index) const {
  if (index < 0 || index >= static_cast<int>(slots_.size()) ||
      slots_[static_cast<std::size_t>(index)].spline.width() == 0) {
    throw InvalidArgument("no frame in this slot");
  }
  return slots_[static_cast<std::size_t>(index)];
}

WindowMotion IcgnReference::refine(const Window& window, const WindowMotion& seed) const {
  if (seed.status != static_cast<idic_int>(WindowStatus::ok)) return seed;
  const Slot& first = slot(window.first);
  const BSplineImage& second = slot(window.second).spline;
  const int side = options_.window_px;
  const double half = (side - 1) / 2.0;
  const Vector2d centre(window.x0 + half, window.y0 + half);
  WindowMotion motion = seed;
  motion.correlation = std::numeric_limits<float>::quiet_NaN();

  const double turn = window.guess_rot_rad;
  Warp warp{
      (Matrix2d() << std::cos(turn), std::sin(turn), -std::sin(turn), std::cos(turn)).finished(),
      Vector2d(seed.u, seed.v)};
  if (window.x0 < 0 || window.y0 < 0 || window.x0 + side > second.width() ||
      window.y0 + side > second.height() || !in_view(second, warp, centre, half)) {
    return failed(motion, WindowStatus::out_of_view);
  }

  Template model;
  model.at.resize(side * side, 2);
  model.f.resize(side * side);
  model.jacobian.resize(side * side, 6);
  Eigen::Index count = 0;
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      const double px = window.x0 + i, py = window.y0 + j, x = i - half, y = j - half;
      if (std::hypot(px - first.cx_px, py - first.cy_px) > first.radius_px) continue;
      const auto s = first.spline.sample(px, py);
      model.at.row(count) << x, y;
      model.f(count) = s.value;
      model.jacobian.row(count) << s.slope_x, s.slope_x * x, s.slope_x * y, s.slope_y,
          s.slope_y * x, s.slope_y * y;
      ++count;
    }
  }
  if (count < 0.5 * side * side) return failed(motion, WindowStatus::masked);
  model.at.conservativeResize(count, 2);
  model.f.conservativeResize(count);
  model.jacobian.conservativeResize(count, 6);

  const double contrast = centred_norm(model.f);
  const double floor = options_.min_texture * first.full_scale / 255;
  if (contrast < floor * std::sqrt(static_cast<double>(count))) {
    return failed(motion, WindowStatus::no_texture);
  }
  const Eigen::VectorXd f_unit = (model.f.array() - model.f.mean()).matrix() / contrast;
  project_out(f_unit, model.jacobian);
  const Eigen::Matrix<double, 6, 6> hessian = model.jacobian.transpose() * model.jacobian;
  const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> solver(hessian);
  if (solver.vectorD().minCoeff() <= 1e-9 * hessian.diagonal().maxCoeff() / (1 + half * half)) {
    return failed(motion, WindowStatus::no_texture);
  }

  Eigen::VectorXd g(count);
  double gain = 1, variance = 0;
  bool converged = false;
  for (int iteration = 0; iteration < options_.max_iterations && !converged; ++iteration) {
    for (Eigen::Index k = 0; k < count; ++k) {
      const Vector2d p = centre + warp.t + warp.a * model.at.row(k).transpose();
      g(k) = second.value(p.x(), p.y());
    }
    motion.correlation =
        static_cast<float>(f_unit.dot((g.array() - g.mean()).matrix()) / centred_norm(g));
    // g ≈ offset + gain (f + J δ): δ sees only what f and a constant leave over.
    Eigen::MatrixXd rest = g;
    project_out(f_unit, rest);
    const Row q = solver.solve(model.jacobian.transpose() * rest.col(0)).transpose();
    const Eigen::VectorXd fitted = model.jacobian * q.transpose();
    variance = (rest.col(0) - fitted).squaredNorm() / static_cast<double>(count - 8);
    // The gain at the minimum; its coupling with δ vanishes there.
    gain = f_unit.dot(g) / contrast;
    if (!(gain > 0)) return failed(motion, WindowStatus::low_correlation);
    const Row delta = q / gain;
    const Matrix2d step = (Matrix2d() << 1 + delta(1), delta(2), delta(4), 1 + delta(5)).finished();
    warp.a = warp.a * step.inverse();
    warp.t -= warp.a * Vector2d(delta(0), delta(3));
    if (std::abs(warp.t.x() - seed.u) > half || std::abs(warp.t.y() - seed.v) > half) {
      return failed(motion, WindowStatus::not_converged);
    }
    if (!in_view(second, warp, centre, half)) return failed(motion, WindowStatus::out_of_view);
    converged = delta.cwiseAbs().maxCoeff() < 1e-9;
  }
  if (!converged) return failed(motion, WindowStatus::not_converged);
  if (motion.correlation < options_.min_correlation) {
    return failed(motion, WindowStatus::low_correlation);
  }
  const Eigen::Matrix<double, 6, 6> inverse = solver.solve(Eigen::Matrix<double, 6, 6>::Identity());
  const double both = variance * 2 /
                      (1 + noise_in_window(options_.spline_degree, warp, centre, half)) /
                      (gain * gain);
  motion.u = static_cast<float>(warp.t.x());
  motion.v = static_cast<float>(warp.t.y());
  motion.u_sd = static_cast<float>(std::sqrt(both * inverse(0, 0)));
  motion.v_sd = static_cast<float>(std::sqrt(both * inverse(3, 3)));
  motion.ux = static_cast<float>(warp.a(0, 0) - 1);
  motion.uy = static_cast<float>(warp.a(0, 1));
  motion.vx = static_cast<float>(warp.a(1, 0));
  motion.vy = static_cast<float>(warp.a(1, 1) - 1);
  return motion;
}

}  // namespace impactdic
