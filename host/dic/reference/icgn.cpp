#include "host/dic/reference/icgn.h"

#include <impactdic/error.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <optional>

#include "host/dic/frames/spline_taps.h"

namespace impactdic::dic {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using SlopeRow = Eigen::Matrix<double, 1, 6>;

// As CLOSE_ENOUGH_PX of kernels/icgn/icgn.cl.
constexpr double kCloseEnoughPx = 5e-4;

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

// The pixels of the window inside the disc.
Template make_template(const BSplineImage& first, const Window& window, int side,
                       const Vector2d& disc_centre, double disc_radius_px) {
  const double half = (side - 1) / 2.0;
  Template model;
  model.at.resize(side * side, 2);
  model.f.resize(side * side);
  model.jacobian.resize(side * side, 6);
  Eigen::Index count = 0;
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      const Vector2d p(window.x0 + i, window.y0 + j);
      if ((p - disc_centre).norm() > disc_radius_px) continue;
      const double x = i - half, y = j - half;
      const auto s = first.sample(p.x(), p.y());
      model.at.row(count) << x, y;
      model.f(count) = s.value;
      model.jacobian.row(count) << s.slope_x, s.slope_x * x, s.slope_x * y, s.slope_y,
          s.slope_y * x, s.slope_y * y;
      ++count;
    }
  }
  model.at.conservativeResize(count, 2);
  model.f.conservativeResize(count);
  model.jacobian.conservativeResize(count, 6);
  return model;
}

// W ∘ (1 + Dδ)⁻¹.
void compose(const SlopeRow& delta, Warp& warp) {
  const Matrix2d step = (Matrix2d() << 1 + delta(1), delta(2), delta(4), 1 + delta(5)).finished();
  warp.a = warp.a * step.inverse();
  warp.t -= warp.a * Vector2d(delta(0), delta(3));
}

// Largest displacement of a pixel by δ (an upper bound), px.
double largest_move(const SlopeRow& delta, double half) {
  return std::max(std::abs(delta(0)) + half * (std::abs(delta(1)) + std::abs(delta(2))),
                  std::abs(delta(3)) + half * (std::abs(delta(4)) + std::abs(delta(5))));
}

// The minimum of ZNSSD about a start.
struct Minimum {
  WindowStatus status = WindowStatus::kOk;
  Warp warp;
  double correlation = std::numeric_limits<double>::quiet_NaN();
  double variance = 0;  // of the residual
  double gain = 1;
};

// Variance of both components of the displacement per unit of the variance of the pictures'
// difference: T⁻¹ (T + K) T⁻¹ of kernels/icgn/icgn.cl. Infinite where there is no texture.
struct Spread {
  double u = std::numeric_limits<double>::infinity(), v = u;
};

// `noise`: one standard deviation of the pictures' difference, as a displacement sees it.
void put(const Warp& warp, double noise, const Spread& spread, WindowMotion& motion) {
  motion.u = static_cast<float>(warp.t.x());
  motion.v = static_cast<float>(warp.t.y());
  motion.u_sd = static_cast<float>(noise * std::sqrt(spread.u));
  motion.v_sd = static_cast<float>(noise * std::sqrt(spread.v));
  motion.ux = static_cast<float>(warp.a(0, 0) - 1);
  motion.uy = static_cast<float>(warp.a(0, 1));
  motion.vx = static_cast<float>(warp.a(1, 0));
  motion.vy = static_cast<float>(warp.a(1, 1) - 1);
}

class WindowRegistration {
 public:
  WindowRegistration(Template model, const BSplineImage& second, const Vector2d& centre,
                     double half)
      : model_(std::move(model)), second_(second), centre_(centre), half_(half) {
    contrast_ = centred_norm(model_.f);
    f_unit_ = (model_.f.array() - model_.f.mean()).matrix() / contrast_;
    slopes_ = model_.jacobian.col(0).squaredNorm() + model_.jacobian.col(3).squaredNorm();
    project_out(f_unit_, model_.jacobian);
    const Eigen::Matrix<double, 6, 6> hessian = model_.jacobian.transpose() * model_.jacobian;
    solver_.compute(hessian);
    singular_ =
        !(solver_.vectorD().minCoeff() > 1e-9 * hessian.diagonal().maxCoeff() / (1 + half * half));
  }
  bool singular() const { return singular_; }
  double rms_contrast() const {
    return contrast_ / std::sqrt(static_cast<double>(model_.f.size()));
  }

  // Σ |∇f|².
  double slopes() const { return slopes_; }
  // `slope_variance`: of slopes that are not the picture's.
  Spread spread(double slope_variance) const {
    const double shift = slope_variance * static_cast<double>(model_.f.size());
    const double change = shift * half_ * (half_ + 1) / 3;  // of a whole window's pixels
    const SlopeRow noise = (SlopeRow() << shift, change, change, shift, change, change).finished();
    Eigen::Matrix<double, 6, 6> texture = model_.jacobian.transpose() * model_.jacobian;
    texture.diagonal() -= noise.transpose();
    const Eigen::LLT<Eigen::Matrix<double, 6, 6>> factor(texture);
    if (factor.info() != Eigen::Success) return {};
    const auto of = [&](int column) {
      const Eigen::Matrix<double, 6, 1> unit = Eigen::Matrix<double, 6, 1>::Unit(column);
      const Eigen::Matrix<double, 6, 1> row = factor.solve(unit);
      return row(column) + row.cwiseAbs2().dot(noise.transpose());
    };
    return {of(0), of(3)};
  }

  // Iterates to double precision; a step of the first `max_iterations` must be below
  // kCloseEnoughPx.
  Minimum run(const Warp& start, int max_iterations) const {
    Minimum result;
    result.warp = start;
    bool close = false;
    for (int iteration = 0; iteration < 20 * max_iterations; ++iteration) {
      const double moved = step(result);
      if (result.status != WindowStatus::kOk) return result;
      if ((result.warp.t - start.t).cwiseAbs().maxCoeff() > half_) {
        result.status = WindowStatus::kNotConverged;
      } else if (!in_view(second_, result.warp, centre_, half_)) {
        result.status = WindowStatus::kOutOfView;
      }
      close = close || moved < kCloseEnoughPx;
      if (iteration + 1 == max_iterations && !close) result.status = WindowStatus::kNotConverged;
      if (result.status != WindowStatus::kOk || moved < 1e-9) return result;
    }
    return result;
  }

 private:
  // One Gauss–Newton step: g ≈ offset + gain (f + J δ), where δ sees only what f and a constant
  // leave over. Returns the largest move.
  double step(Minimum& result) const {
    Eigen::VectorXd g(model_.f.size());
    for (Eigen::Index k = 0; k < g.size(); ++k) {
      const Vector2d p = centre_ + result.warp.t + result.warp.a * model_.at.row(k).transpose();
      g(k) = second_.value(p.x(), p.y());
    }
    result.correlation = f_unit_.dot((g.array() - g.mean()).matrix()) / centred_norm(g);
    const double gain = f_unit_.dot(g) / contrast_;
    if (!(gain > 0)) {
      result.status = WindowStatus::kLowCorrelation;
      return 0;
    }
    project_out(f_unit_, g);
    const SlopeRow q = solver_.solve(model_.jacobian.transpose() * g).transpose();
    result.variance =
        (g - model_.jacobian * q.transpose()).squaredNorm() / static_cast<double>(g.size() - 8);
    result.gain = gain;
    const SlopeRow delta = q / gain;
    compose(delta, result.warp);
    return largest_move(delta, half_);
  }

  Template model_;
  const BSplineImage& second_;
  Vector2d centre_;
  double half_, contrast_, slopes_;
  Eigen::VectorXd f_unit_;
  Eigen::LDLT<Eigen::Matrix<double, 6, 6>> solver_;
  bool singular_ = false;
};

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
  const auto status = static_cast<WindowStatus>(seed.status);
  const bool lost = status == WindowStatus::kLowCorrelation ||
                    status == WindowStatus::kAtSearchEdge || status == WindowStatus::kNotConverged;
  if (status != WindowStatus::kOk && !lost) return seed;
  const Slot& first = slot(window.first);
  const BSplineImage& second = slot(window.second).spline;
  const int side = options_.window_px;
  const double half = (side - 1) / 2.0;
  const Vector2d centre(window.x0 + half, window.y0 + half);
  WindowMotion motion = seed;
  motion.correlation = std::numeric_limits<float>::quiet_NaN();

  const double c = std::cos(window.guess_rot_rad), s = std::sin(window.guess_rot_rad);
  const Warp start{(Matrix2d() << c, s, -s, c).finished(), Vector2d(seed.u, seed.v)};
  const bool is_inside = window.x0 >= 0 && window.y0 >= 0 && window.x0 + side <= second.width() &&
                         window.y0 + side <= second.height();
  if (lost && !is_inside) return seed;
  if (!is_inside || (!lost && !in_view(second, start, centre, half))) {
    return failed(motion, WindowStatus::kOutOfView);
  }
  Template model =
      make_template(first.spline, window, side, {first.cx_px, first.cy_px}, first.radius_px);
  const auto count = static_cast<double>(model.f.size());
  if (count < 0.5 * side * side) {
    return failed(motion, WindowStatus::kMasked);
  }
  const WindowRegistration registration(std::move(model), second, centre, half);
  const double known_variance = pixel_variance(options_, first.full_scale);
  const double least = options_.min_texture * first.full_scale / 255;
  const double doubt =
      known_variance + kInterpolationPx * kInterpolationPx * registration.slopes() / count;
  const Spread spread = registration.spread(doubt * slope_noise(options_.spline_degree));
  const double most = options_.max_sd_px * options_.max_sd_px / (2 * doubt);
  if (registration.rms_contrast() < std::sqrt(least * least + known_variance) ||
      registration.singular() || !(spread.u <= most && spread.v <= most)) {
    return failed(motion, WindowStatus::kNoTexture);
  }
  if (lost) return seed;
  const Minimum found = registration.run(start, options_.max_iterations);
  motion.correlation = static_cast<float>(found.correlation);
  if (found.status != WindowStatus::kOk) return failed(motion, found.status);
  if (found.correlation < options_.min_correlation) {
    return failed(motion, WindowStatus::kLowCorrelation);
  }
  // Both frames' noise, of which the residual holds the second one's after interpolation; at least
  // that of rounding to whole grey levels.
  const double variance = std::max(
      found.variance / (1 + noise_in_window(options_.spline_degree, found.warp, centre, half)),
      1.0 / 12);
  put(found.warp, std::sqrt(2 * variance) / found.gain, spread, motion);
  return motion;
}

}  // namespace impactdic::dic
