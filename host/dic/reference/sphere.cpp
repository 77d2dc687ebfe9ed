#include "host/dic/reference/sphere.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "host/base/statistics.h"
#include "host/dic/frames/bspline.h"
#include "host/dic/sphere/rotation.h"
#include "host/dic/sphere/sphere_sight.h"

namespace impactdic::dic {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kLight = 4, kMotion = 5, kColumns = kLight + kMotion;
// Of the radius, as in the kernel: from where a pixel counts, and from where wholly.
constexpr double kLeastDepth = 0.2, kFullDepth = 0.4;
constexpr double kFullShare = 0.91;  // of the disc's area, of a sphere that is seen whole
constexpr double kBlurChange = 4.5;
constexpr double kSphereTukey = 6, kLongestStretch = 1.3;
// Bends, as in kernels/ball/bend.h: what blurs, in shares of what blurs second differences, and the
// sines of the tilt up to which they are taken off wholly and from which on not at all.
constexpr double kBlurOfBends = 0.9, kFullBend = 0.14, kNoBend = 0.21;
constexpr double kStep = 1e-4;  // px and rad, of differences
using Row = Eigen::Matrix<double, kColumns, 1>;
using Motion = Eigen::Matrix<double, kMotion, 1>;
using Normal = Eigen::Matrix<double, kColumns, kColumns>;

Eigen::Matrix2d stretch_of(const float* strain) {
  Eigen::Matrix2d stretch;
  stretch << 1 + strain[0], strain[1], strain[1], 1 + strain[2];
  return stretch;
}

// What bare paint shows at the normal `n`.
double light_at(const BallLight& light, const Vector3d& n) {
  const double facing = light.lamp[0] * n.x() + light.lamp[1] * n.y() + light.lamp[2] * n.z();
  return std::max<double>(light.ambient + std::max(facing, 0.0), light.least);
}

// Where the sphere's motion takes a pixel: x right, y down, from the centre in the first picture.
struct SphereWarp {
  Vector2d shift;
  Eigen::Matrix3d turn;
  double radius;
  SphereSight first, second;  // the latter of a ball that has not moved

  SphereSight moved() const {
    SphereSight sight = second;
    sight.aside += sight.by_distance * shift;
    return sight;
  }
  Vector3d turned(const Vector2d& p) const { return turn * first.on_ball(p, radius); }
  Vector2d operator()(const Vector2d& p) const { return shift + moved().picture(turned(p)); }
  // By what the turn stretches the round ball's picture there, seen along lines of sight that lean
  // as they do there: J^-1 J^-T - 1 of kernels/ball/blur.h.
  Eigen::Matrix2d blurring(const Vector2d& p) const {
    const Vector3d seen = first.on_ball(p, radius), then = turn * seen;
    const Vector2d ray = first.leans(p), later = moved().leans(moved().picture(then));
    const auto across = [&](const Vector2d& q) -> Vector2d {
      const double a = 1 + ray.squaredNorm(), b = q.dot(ray);
      const double c = q.squaredNorm() - radius * radius;
      const double z = (b + std::sqrt(std::max(0.0, b * b - a * c))) / a;
      const Vector2d at = q - z * ray;
      const Vector3d after = turn * Vector3d(at.x(), at.y(), z);
      return after.head<2>() + after.z() * later;
    };
    const Vector2d from = seen.head<2>() + seen.z() * ray;
    Eigen::Matrix2d derivative;
    for (int axis : {0, 1}) {
      const Vector2d step = kStep * Vector2d::Unit(axis);
      derivative.col(axis) = (across(from + step) - across(from - step)) / (2 * kStep);
    }
    const Eigen::Matrix2d back = derivative.inverse();
    return back * back.transpose() - Eigen::Matrix2d::Identity();
  }
  // How many times as large an area of the surface looks in the first picture as in the second.
  double narrowing(const Vector2d& p) const {
    const Vector3d seen = first.on_ball(p, radius), then = turn * seen;
    const auto slant = [](const Vector3d& q, const Vector2d& ray) {
      return q.z() - ray.dot(q.head<2>());
    };
    return slant(seen, first.leans(p)) / slant(then, moved().leans(moved().picture(then)));
  }
  // The lesser cosine of the surface's angle to the line of sight.
  double facing(const Vector2d& p) const {
    return std::min(first.facing(first.on_ball(p, radius), radius),
                    moved().facing(turned(p), radius));
  }
};

class SphereRegistration {
 public:
  SphereRegistration(const BSplineImage& first, const BSplineImage& second, const BallTask& task,
                     const BallOptions& options, double grey_level)
      : first_(first),
        second_(second),
        options_(options),
        task_(task),
        centre_(task.cx, task.cy),
        smallest_scale_(grey_level),
        bends_(first.width(), first.height()) {
    const Vector3d guess(task.guess_rot_x_rad, task.guess_rot_y_rad, task.guess_rot_rad);
    turn_ = quaternion_of(guess);
    shift_ = Vector2d(task.guess_dx, task.guess_dy);
  }

  // Registers, and takes off what bends have made of the motion. False where the regression is
  // singular.
  bool run() {
    if (!settle()) return false;
    see_bends();
    double moved = 1;
    if (!step(moved)) return false;
    unbend();
    return true;
  }

  BallMotion result() const {
    const Vector3d vector = rotation_vector(turn_);
    BallMotion motion{};
    motion.dx = static_cast<float>(shift_.x());
    motion.dy = static_cast<float>(shift_.y());
    motion.rot_x_rad = static_cast<float>(vector.x());
    motion.rot_y_rad = static_cast<float>(vector.y());
    motion.rot_rad = static_cast<float>(vector.z());
    motion.correlation = static_cast<float>(correlation_);
    motion.residual = static_cast<float>(std::sqrt(variance_));
    const double whole = kFullShare * std::numbers::pi * task_.radius * task_.radius;
    motion.used = static_cast<float>(carried_ / whole);
    motion.steps = steps_;
    return motion;
  }

 private:
  // Steps of Gauss and Newton until they vanish. False where the regression is singular.
  bool settle() {
    double moved = 1;
    for (int k = 0; k < 100; ++k) {
      if (!step(moved)) return false;
      ++steps_;
      if (moved < 1e-9 && (!options_.robust || scale_ > 0)) return true;
    }
    return moved < 1e-6;
  }

  SphereWarp warp(const Vector3d& turned_on = Vector3d::Zero(),
                  const Vector2d& moved_on = Vector2d::Zero()) const {
    const BallSight& s = task_.sight;
    return {shift_ + moved_on,
            in_picture(turn_ * quaternion_of(turned_on)),
            task_.ball_radius,
            {s.by_distance, {s.first_x, s.first_y}, stretch_of(s.first)},
            {s.by_distance, {s.second_x, s.second_y}, stretch_of(s.second)}};
  }

  // Second differences of what `of` says of the first picture's pixels; 0 at its border.
  template <typename Of>
  Eigen::Matrix2d differences(int x, int y, const Of& of) const {
    if (x < 1 || y < 1 || x >= first_.width() - 1 || y >= first_.height() - 1) {
      return Eigen::Matrix2d::Zero();
    }
    const auto f = [&](int dx, int dy) { return of(x + dx, y + dy); };
    const double xy = (f(1, 1) - f(1, -1) - f(-1, 1) + f(-1, -1)) / 4;
    Eigen::Matrix2d second;
    second << f(1, 0) + f(-1, 0) - 2 * f(0, 0), xy, xy, f(0, 1) + f(0, -1) - 2 * f(0, 0);
    return second;
  }

  Eigen::Matrix2d curvature(int x, int y) const {
    return differences(x, y, [&](int i, int j) { return first_.value(i, j); });
  }

  // What bends change of the first picture's pixels, see kernels/ball/bend.h; lines of sight are
  // taken to be parallel.
  void see_bends() {
    const Eigen::Matrix3d turn = in_picture(turn_);
    const Vector2d q(turn(2, 0), turn(2, 1));
    if (turn(2, 2) < 0) return;
    const double share = std::clamp((kNoBend - q.norm()) / (kNoBend - kFullBend), 0.0, 1.0);
    const double blur = kBlurOfBends * task_.blur, radius = task_.ball_radius;
    const auto along = [&](int x, int y) {
      const BSplineImage::Sample f = first_.sample(x, y);
      return q.dot(Vector2d(f.slope_x, f.slope_y));
    };
    for (int y = 0; y < first_.height(); ++y) {
      for (int x = 0; x < first_.width(); ++x) {
        const Vector2d p = Vector2d(x, y) - centre_;
        if (p.squaredNorm() >= task_.radius * task_.radius) continue;
        const Vector3d then =
            turn * Vector3d(p.x(), p.y(), std::sqrt(radius * radius - p.squaredNorm()));
        const double z = std::max(then.z(), kLeastDepth * radius);
        const Vector2d tilt = then.head<2>() / z;
        const Eigen::Matrix2d bent =
            -(Eigen::Matrix2d::Identity() + tilt * tilt.transpose()) / z;  // ∇∇z
        const Eigen::Matrix2d back = turn.topLeftCorner<2, 2>().transpose() - q * tilt.transpose();
        const Eigen::Matrix2d skew = back * bent * back.transpose();
        bends_(x, y) =
            share * blur / 2 *
            (bent.trace() * along(x, y) + blur * (skew * differences(x, y, along)).trace());
      }
    }
  }

  // Light where the second picture shows what the first one shows at `p`, over that there.
  double brightening(const Vector2d& p, const SphereWarp& here) const {
    if (!options_.lit) return 1;
    return light_at(task_.light, here.turned(p) / here.radius) /
           light_at(task_.light, here.first.on_ball(p, here.radius) / here.radius);
  }

  // The first picture without the slopes of the light, which does not move with the ball.
  void take_light_off(const Vector2d& p, const SphereWarp& here, BSplineImage::Sample& f) const {
    if (!options_.lit) return;
    const auto level = [&](const Vector2d& at) {
      return light_at(task_.light, here.first.on_ball(at, here.radius) / here.radius);
    };
    const double share = f.value / level(p);
    const Vector2d x = kStep * Vector2d::UnitX(), y = kStep * Vector2d::UnitY();
    f.slope_x -= share * (level(p + x) - level(p - x)) / (2 * kStep);
    f.slope_y -= share * (level(p + y) - level(p - y)) / (2 * kStep);
  }

  // What moves the second picture there as much as each parameter does, on the first one.
  Eigen::Matrix<double, 2, kMotion> shifts(
      const Vector2d& p, const SphereWarp& here,
      const std::array<SphereWarp, 2 * kMotion>& moved_on) const {
    Eigen::Matrix2d local;
    for (int axis : {0, 1}) {
      const Vector2d step = kStep * Vector2d::Unit(axis);
      local.col(axis) = (here(p + step) - here(p - step)) / (2 * kStep);
    }
    Eigen::Matrix<double, 2, kMotion> moved;
    for (std::size_t k = 0; k < kMotion; ++k) {
      moved.col(static_cast<Eigen::Index>(k)) =
          (moved_on[2 * k](p) - moved_on[2 * k + 1](p)) / (2 * kStep);
    }
    return local.inverse() * moved;
  }

  // The warp with a little more and a little less of each motion.
  std::array<SphereWarp, 2 * kMotion> around() const {
    const auto shifted = [&](const Vector2d& by) { return warp(Vector3d::Zero(), kStep * by); };
    const auto turned = [&](const Vector3d& by) { return warp(kStep * by); };
    return {shifted(Vector2d::UnitX()),  shifted(-Vector2d::UnitX()), shifted(Vector2d::UnitY()),
            shifted(-Vector2d::UnitY()), turned(Vector3d::UnitX()),   turned(-Vector3d::UnitX()),
            turned(Vector3d::UnitY()),   turned(-Vector3d::UnitY()),  turned(Vector3d::UnitZ()),
            turned(-Vector3d::UnitZ())};
  }

  // Tukey's biweight w(r), and d(w r)/dr; 1 where there is no scale yet.
  std::pair<double, double> biweight(double r) const {
    if (!(scale_ > 0)) return {1, 1};
    const double u2 = std::pow(r / (kSphereTukey * scale_), 2), rest = std::max(0.0, 1 - u2);
    return {rest * rest, rest * (1 - 5 * u2)};
  }

  // What a pass over the disc sums up: of the regression, of Newton's matrix and of bends; and the
  // sizes of the residuals.
  struct Sums {
    Normal normal = Normal::Zero();
    Row right = Row::Zero(), bent = Row::Zero();
    double gg = 0, g_sum = 0, newton = 0;
    std::vector<double> sizes;
  };

  Sums pass() const {
    Sums sums;
    const SphereWarp here = warp();
    const auto moved_on = around();
    const Eigen::Matrix2d round = stretch_of(task_.sight.first).inverse();
    for (int y = 0; y < first_.height(); ++y) {
      for (int x = 0; x < first_.width(); ++x) {
        const Vector2d p = Vector2d(x, y) - centre_;
        if (p.squaredNorm() >= task_.radius * task_.radius) continue;
        if ((round * p).squaredNorm() >= task_.radius * task_.radius) continue;
        const double cosine = here.facing(p);
        double w = std::clamp((cosine - kLeastDepth) / (kFullDepth - kLeastDepth), 0.0, 1.0);
        const Vector2d at = centre_ + here(p);
        if (!(w > 0 && at.x() >= 0 && at.y() >= 0 && at.x() <= second_.width() - 1 &&
              at.y() <= second_.height() - 1)) {
          continue;
        }
        const Eigen::Matrix2d changed = here.blurring(p);
        w /= 1 + std::pow(std::pow(task_.blur, 2) * changed.squaredNorm() / kBlurChange, 2);
        w *= 2 / (1 + here.narrowing(p));  // both pictures' noise
        const double lit = brightening(p, here);
        w *= 2 / (1 + lit * lit);
        const double g = second_.value(at.x(), at.y()) -
                         light_(1) * lit * task_.blur / 2 * (changed * curvature(x, y)).trace();
        BSplineImage::Sample f = first_.sample(x, y);
        take_light_off(p, here, f);
        for (double* part : {&f.value, &f.slope_x, &f.slope_y}) *part *= lit;
        Row row;
        row.head<kLight>() << 1, f.value, f.value * p.x() / task_.radius,
            f.value * p.y() / task_.radius;
        row.tail<kMotion>() =
            shifts(p, here, moved_on).transpose() * Vector2d(f.slope_x, f.slope_y);
        const double r = g - light_.dot(row.head<kLight>());
        sums.sizes.push_back(std::abs(r));
        const auto [robust, of_newton] = biweight(r);
        sums.newton += w * of_newton;
        w *= robust;
        sums.bent += w * light_(1) * bends_(x, y) * row;
        sums.normal += w * row * row.transpose();
        sums.right += w * g * row;
        sums.g_sum += w * g;
        sums.gg += w * g * g;
      }
    }
    return sums;
  }

  bool step(double& moved) {
    Sums sums = pass();
    const Eigen::LDLT<Normal> solver(sums.normal);
    const Row solution = solver.solve(sums.right);
    carried_ = sums.normal(0, 0);
    const double f_mean = sums.normal(0, 1) / carried_, g_mean = sums.g_sum / carried_;
    const double ff = sums.normal(1, 1) - carried_ * f_mean * f_mean;
    const double gg = sums.gg - carried_ * g_mean * g_mean;
    correlation_ = (sums.right(1) - carried_ * f_mean * g_mean) / std::sqrt(ff * gg);
    variance_ = (sums.gg - solution.dot(sums.right)) / (carried_ - kColumns);
    light_ = solution.head<kLight>();
    bent_ = std::clamp(carried_ / sums.newton, 1.0, kLongestStretch) * solver.solve(sums.bent);
    if (!(light_(1) > 0) || !(solver.vectorD().minCoeff() > 0)) return false;
    const Motion by = solution.tail<kMotion>() / light_(1);
    move(-by);
    moved = by.head<2>().norm() + task_.radius * by.tail<3>().norm();
    if (options_.robust && moved < 0.5) {
      scale_ = std::max(kSdOfMad * upper_median(std::move(sums.sizes)), smallest_scale_);
    }
    return true;
  }

  void move(const Motion& by) {
    shift_ += by.head<2>();
    turn_ = (turn_ * quaternion_of(by.tail<3>())).normalized();
  }

  // Bends are in the second picture, so that the motion found is too far by what they give to a
  // step: taken off with the last one's weights, as long as Newton's step.
  void unbend() { move(bent_.tail<kMotion>() / light_(1)); }

  const BSplineImage &first_, &second_;
  const BallOptions& options_;
  BallTask task_;
  Vector2d centre_, shift_;
  Eigen::Quaterniond turn_;
  Eigen::Vector4d light_ = {0, 1, 0, 0};
  double scale_ = 0, smallest_scale_;
  Image<double> bends_;     // grey levels of the first picture
  Row bent_ = Row::Zero();  // what they give to a step
  double correlation_ = 0, variance_ = 0, carried_ = 0;
  int steps_ = 0;
};

}  // namespace

BallMotion sphere_reference(const Frame& first, const Frame& second, const BallTask& task,
                            const BallOptions& options) {
  const BSplineImage f(to_double(first), options.spline_degree, options.presmooth_sigma_px);
  const BSplineImage g(to_double(second), options.spline_degree, options.presmooth_sigma_px);
  SphereRegistration registration(f, g, task, options, first.full_scale() / 255);
  if (registration.run()) return registration.result();
  BallMotion failed{};
  const float nan = std::numeric_limits<float>::quiet_NaN();
  failed.status = static_cast<idic_int>(WindowStatus::kNotConverged);
  failed.dx = failed.dy = failed.rot_x_rad = failed.rot_y_rad = failed.rot_rad = nan;
  return failed;
}

}  // namespace impactdic::dic
