#include "host/motion/field_motion.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "host/dic/point_columns.h"
#include "host/dic/sphere/rotation.h"
#include "host/dic/sphere/sphere_fit.h"

namespace impactdic::motion {

namespace {

// What std::lround says, without a call for every window.
int rounded(double x) {
  constexpr double kBelowHalf = 0.49999999999999994;  // a half would round what is below it up
  return static_cast<int>(x + std::copysign(kBelowHalf, x));
}

}  // namespace

void aim_windows(std::span<Window> windows, int window_px, int first_slot, int second_slot,
                 const MotionGuess& guess, std::span<WindowMotion> seeds) {
  const double half = (window_px - 1) / 2.0;
  // Counter-clockwise on the screen, with y down.
  const double c = std::cos(guess.rot_rad) - 1, s = std::sin(guess.rot_rad);
  for (std::size_t i = 0; i < windows.size(); ++i) {
    Window& window = windows[i];
    const double x = window.x0 + half - guess.cx_px, y = window.y0 + half - guess.cy_px;
    const double u = guess.dx_px + c * x + s * y, v = guess.dy_px - s * x + c * y;
    window.first = first_slot;
    window.second = second_slot;
    window.guess_u = rounded(u);
    window.guess_v = rounded(v);
    window.guess_rot_rad = static_cast<float>(guess.rot_rad);
    if (!seeds.empty()) seeds[i] = dic::seed_at(u, v);
  }
}

void aim_on_sphere(std::span<Window> windows, int window_px, int first_slot, int second_slot,
                   const dic::SphereGuess& guess, std::span<WindowMotion> seeds) {
  const double half = (window_px - 1) / 2.0;
  const double turn_z = dic::rotation_vector(guess.turn).z();
  for (std::size_t i = 0; i < windows.size(); ++i) {
    Window& window = windows[i];
    const double x = window.x0 + half, y = window.y0 + half;
    double to_x = x + guess.dx_px, to_y = y + guess.dy_px;
    dic::carry(guess, x, y, to_x, to_y);
    window.first = first_slot;
    window.second = second_slot;
    window.guess_u = rounded(to_x - x);
    window.guess_v = rounded(to_y - y);
    window.guess_rot_rad = static_cast<float>(turn_z);
    if (!seeds.empty()) seeds[i] = dic::seed_at(to_x - x, to_y - y);
  }
}

std::vector<dic::PointMotion> field_points(std::span<const Window> windows,
                                           std::span<const WindowMotion> motions, int window_px,
                                           double floor_px) {
  const double half = (window_px - 1) / 2.0;
  std::vector<dic::PointMotion> points;
  points.reserve(windows.size());
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const WindowMotion& motion = motions[i];
    if (motion.status != static_cast<idic_int>(WindowStatus::kOk)) continue;
    const double sd = std::sqrt(0.5 * (motion.u_sd * motion.u_sd + motion.v_sd * motion.v_sd));
    points.push_back({windows[i].x0 + half, windows[i].y0 + half, motion.u, motion.v,
                      std::isfinite(sd) ? std::max(sd, floor_px) : floor_px});
  }
  return points;
}

void account_for_overlap(dic::RigidMotion& motion, int window_px, int spacing_px) {
  const double wider = std::max(1.0, static_cast<double>(window_px) / spacing_px);
  motion.dx_sd_px *= wider;
  motion.dy_sd_px *= wider;
  motion.rot_sd_rad *= wider;
}

namespace {

using Eigen::ArrayXf;

// One component's scatter from the squared lengths of two-dimensional residuals.
float scatter_of(const ArrayXf& squares) {
  constexpr float kRayleighMedian = 1.1774F;
  return std::max(std::sqrt(dic::upper_median(squares)) / kRayleighMedian, 1e-6F);
}

// Tukey's weights, cut off at six times the scatter: an expression.
auto robust_weights(const ArrayXf& squares, float scatter) {
  return dic::biweight(1 / (36 * scatter * scatter) * squares);
}

// The `count` points nearest to (cx, cy); of equally near ones those that come first.
std::vector<dic::PointMotion> nearest(std::span<const dic::PointMotion> points, std::size_t count,
                                      double cx, double cy) {
  if (points.size() <= count) return {points.begin(), points.end()};
  std::vector<float> squares;
  squares.reserve(points.size());
  for (const dic::PointMotion& point : points) {
    const double x = point.x_px - cx, y = point.y_px - cy;
    squares.push_back(static_cast<float>(x * x + y * y));
  }
  const float farthest = order_statistic(squares, count - 1);
  auto as_far = static_cast<std::ptrdiff_t>(count) -
                std::count_if(squares.begin(), squares.end(),
                              [farthest](float square) { return square < farthest; });
  std::vector<dic::PointMotion> near;
  near.reserve(count);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (squares[i] > farthest || (squares[i] == farthest && as_far-- <= 0)) continue;
    near.push_back(points[i]);
  }
  return near;
}

}  // namespace

CentreMotion interpolate_at(std::span<const dic::PointMotion> measured, double cx_px,
                            double cy_px) {
  constexpr std::size_t kNeighbours = 25, kFewest = 4;
  constexpr int kRobustRounds = 4;
  if (measured.size() < kFewest) return {};
  const dic::PointColumns points(nearest(measured, kNeighbours, cx_px, cy_px), cx_px, cy_px);
  const ArrayXf distance = (points.x.square() + points.y.square()).sqrt();
  const float reach = 1.001F * distance.maxCoeff() + 1e-9F;
  const ArrayXf tricube = (1 - (distance / reach).cube()).cube();
  ArrayXf weights = tricube * points.per_variance, influence, squares;
  dic::AffineMotion motion;
  float scatter = 0;
  for (int round = 0; round < kRobustRounds; ++round) {
    const dic::Moments moments(points, weights);
    if (moments.on_a_line()) return {};
    motion = moments.affine();
    influence = moments.influence_at_origin(points);
    squares = points.residuals_sq(motion);
    scatter = scatter_of(squares);
    weights = tricube * points.per_variance * robust_weights(squares, scatter);
  }
  // Sandwich variance of the displacement there for residuals of size `scatter`.
  const double sd = scatter * std::sqrt((influence * weights).square().sum());
  return {true, motion.u, motion.v, sd, sd};
}

FieldStrain fit_strain(std::span<const dic::PointMotion> measured, const dic::RigidMotion& rigid,
                       double cx_px, double cy_px) {
  constexpr std::size_t kFewest = 12;
  constexpr int kRounds = 6;
  constexpr double kSettled = 1e-7;  // of the gradient: far below any strain that matters
  if (measured.size() < kFewest) return {};
  const double c = std::cos(rigid.rot_rad) - 1, s = std::sin(rigid.rot_rad);
  const dic::PointColumns points(measured, cx_px, cy_px, {rigid.dx_px, rigid.dy_px, c, s, -s, c});
  ArrayXf weights = ArrayXf::Ones(points.size()), squares;
  dic::AffineMotion motion;
  float scatter = 0;
  double of_gradient = 0;  // of_gradient: its deviation for a scatter of one
  for (int round = 0; round < kRounds; ++round) {
    const dic::Moments moments(points, weights);
    if (moments.on_a_line()) return {};
    const dic::AffineMotion before = std::exchange(motion, moments.affine());
    of_gradient = std::sqrt(std::max(moments.xx, moments.yy) / moments.determinant());
    squares = points.residuals_sq(motion);
    scatter = scatter_of(squares);
    if (round > 0 && (motion - before).gradient_length() < kSettled) break;
    weights = robust_weights(squares, scatter);
  }
  Eigen::Matrix2d stretch;
  stretch << 1 + motion.ux, motion.uy, motion.vx, 1 + motion.vy;
  const Eigen::Matrix2d green = 0.5 * (stretch.transpose() * stretch - Eigen::Matrix2d::Identity());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(green);
  return {true, solver.eigenvalues().cwiseAbs().maxCoeff(), scatter * of_gradient};
}

double agreeing_share(const dic::RigidMotion& motion, std::span<const WindowMotion> motions) {
  const auto could = std::count_if(motions.begin(), motions.end(), [](const WindowMotion& m) {
    const auto status = static_cast<WindowStatus>(m.status);
    return status != WindowStatus::kNoTexture && status != WindowStatus::kOutOfView &&
           status != WindowStatus::kMasked;
  });
  return could > 0 ? static_cast<double>(motion.used) / static_cast<double>(could) : 0;
}

TrackStatus explain_failure(std::span<const WindowMotion> motions) {
  std::size_t bare = 0, outside = 0;
  for (const WindowMotion& motion : motions) {
    bare += motion.status == static_cast<idic_int>(WindowStatus::kNoTexture);
    outside += motion.status == static_cast<idic_int>(WindowStatus::kOutOfView);
  }
  if (outside * 2 > motions.size()) return TrackStatus::kOutOfView;
  return bare * 2 >= motions.size() ? TrackStatus::kNoTexture : TrackStatus::kLowCorrelation;
}

}  // namespace impactdic::motion
