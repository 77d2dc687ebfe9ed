#include "host/sphere/carried_paint.h"

#include <ceres/tiny_solver.h>
#include <ceres/tiny_solver_autodiff_function.h>

#include <Eigen/Dense>
#include <cmath>

namespace impactdic::sphere {
namespace {

constexpr std::size_t kFewest = 100;  // places that tell anything
// Gradient of the first picture over its mean, by the normal, below which no side is lit.
constexpr double kEven = 0.1;
constexpr double kExplains = 0.02;                 // of what the gains leave, at least
constexpr double kOutlier = 3;                     // noises
constexpr double kLeast = 0.02;                    // no place is taken to be darker
constexpr double kStartElevations[] = {0.1, 0.8};  // of the lamp, rad

// What is fitted: offset, gain and the gain's slopes; and then of the lamp its share of the light
// (as a logit), and where it stands: azimuth and elevation, rad.
constexpr int kGains = 4, kAll = 7;
template <int kCount>
using Numbers = Eigen::Matrix<double, kCount, 1>;

template <typename T>
struct Lamp {
  explicit Lamp(const T* numbers)
      : share(1.0 / (1.0 + exp(-numbers[0]))),
        x(cos(numbers[2]) * cos(numbers[1])),
        y(cos(numbers[2]) * sin(numbers[1])),
        z(sin(numbers[2])) {}
  // The light where the surface has the normal `n`.
  T level(const std::array<double, 3>& n) const {
    const T facing = x * n[0] + y * n[1] + z * n[2];
    const T lit = facing > 0.0 ? facing : T(0);
    const T sum = 1.0 - share + share * lit;
    return sum > kLeast ? sum : T(kLeast);
  }
  T share, x, y, z;
};

// What the numbers leave of the second levels, in noises: its square is that of Cauchy's loss.
template <int kCount>
class Left {
 public:
  Left(std::span<const CarriedPaint> paint, double noise) : paint_(paint), noise_(noise) {}
  int NumResiduals() const { return static_cast<int>(paint_.size()); }

  template <typename T>
  bool operator()(const T* numbers, T* left) const {
    for (std::size_t i = 0; i < paint_.size(); ++i) {
      const CarriedPaint& one = paint_[i];
      T ratio(1);
      if constexpr (kCount == kAll) {
        const Lamp<T> lamp(numbers + kGains);
        ratio = lamp.level(one.second_normal) / lamp.level(one.first_normal);
      }
      const T gain =
          numbers[1] + numbers[2] * one.first_normal[0] + numbers[3] * one.first_normal[1];
      left[i] = robust((numbers[0] + gain * ratio * one.first - one.second) / noise_);
    }
    return true;
  }

 private:
  template <typename T>
  static T robust(const T& r) {
    const T square = r * r / (kOutlier * kOutlier);
    return square < 1e-6 ? r : r * sqrt(log(1.0 + square) / square);
  }
  std::span<const CarriedPaint> paint_;
  double noise_;
};

// From `numbers` on, which get the best ones; returns half the sum of squares.
template <int kCount>
double fit(std::span<const CarriedPaint> paint, double noise, Numbers<kCount>& numbers) {
  using Function = Left<kCount>;
  const Function left(paint, noise);
  using Differentiable = ceres::TinySolverAutoDiffFunction<Function, Eigen::Dynamic, kCount>;
  const Differentiable function(left);
  ceres::TinySolver<Differentiable> solver;
  solver.options.max_num_iterations = 40;
  solver.Solve(function, &numbers);
  return solver.summary.final_cost;
}

// The first picture's gradient over its mean, by the normal; x and y.
std::array<double, 2> gradient(std::span<const CarriedPaint> paint) {
  double mean = 0, xx = 0, yy = 0, along_x = 0, along_y = 0, x_mean = 0, y_mean = 0;
  const auto count = static_cast<double>(paint.size());
  for (const CarriedPaint& one : paint) {
    mean += one.first / count;
    x_mean += one.first_normal[0] / count;
    y_mean += one.first_normal[1] / count;
  }
  for (const CarriedPaint& one : paint) {
    const double x = one.first_normal[0] - x_mean, y = one.first_normal[1] - y_mean;
    xx += x * x;
    yy += y * y;
    along_x += x * one.first;
    along_y += y * one.first;
  }
  return {along_x / (xx * mean), along_y / (yy * mean)};
}

}  // namespace

std::optional<BallLight> light_on_paint(std::span<const CarriedPaint> paint, double noise) {
  if (paint.size() < kFewest) return std::nullopt;
  const auto [along_x, along_y] = gradient(paint);
  const double steep = std::hypot(along_x, along_y);
  if (!(steep > kEven)) return std::nullopt;
  Numbers<kGains> gains(0, 1, 0, 0);
  const double even = fit(paint, noise, gains);
  Numbers<kAll> best;
  double least = (1 - kExplains) * even;
  bool is_told = false;
  for (const double elevation : kStartElevations) {
    Numbers<kAll> numbers;
    numbers << gains, 0.5, std::atan2(along_y, along_x), elevation;
    const double cost = fit(paint, noise, numbers);
    if (!(cost < least) || !numbers.allFinite()) continue;
    least = cost;
    best = numbers;
    is_told = true;
  }
  if (!is_told) return std::nullopt;
  const Lamp<double> lamp(best.data() + kGains);
  BallLight told{};
  told.ambient = static_cast<float>(1 - lamp.share);
  told.lamp[0] = static_cast<float>(lamp.share * lamp.x);
  told.lamp[1] = static_cast<float>(lamp.share * lamp.y);
  told.lamp[2] = static_cast<float>(lamp.share * lamp.z);
  told.least = static_cast<float>(kLeast);
  return told;
}

}  // namespace impactdic::sphere
