#include "host/sphere/bare_paint.h"

#include <ceres/tiny_solver.h>
#include <ceres/tiny_solver_autodiff_function.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "host/base/statistics.h"

namespace impactdic::sphere {
namespace {

struct BareSettings {
  std::size_t fewest = 100;  // places that tell anything
  double share = 0.6;        // of the places that must be of one paint
  // What a lamp must add from one side of the ball to the other, share of the mean; and how far a
  // place of that paint may be from what the light makes of it: limbs are darker than matt paint's.
  double even = 0.1, alike = 0.02;
  double least = 0.02;  // of the mean: no place is taken to be darker
  double start_depths[2] = {0.2, 1};
};
constexpr BareSettings kBarePaint;

// Ambient light and the lamp's direction times its light, in mean levels.
using LampNumbers = Eigen::Matrix<double, 4, 1>;

template <typename T>
T light_at(const T* numbers, const std::array<double, 3>& n) {
  const T facing = numbers[1] * n[0] + numbers[2] * n[1] + numbers[3] * n[2];
  return numbers[0] + (facing > 0.0 ? facing : T(0));
}

// Its square is that of Cauchy's loss: marks do not count.
class LeftOfBare {
 public:
  LeftOfBare(std::span<const SeenPaint> paint, double mean, double alike)
      : paint_(paint), mean_(mean), alike_(alike) {}
  int NumResiduals() const { return static_cast<int>(paint_.size()); }

  template <typename T>
  bool operator()(const T* numbers, T* left) const {
    for (std::size_t i = 0; i < paint_.size(); ++i) {
      const T r = (light_at(numbers, paint_[i].normal) - paint_[i].level / mean_) / alike_;
      const T square = r * r;
      left[i] = square < 1e-6 ? r : r * sqrt(log(1.0 + square) / square);
    }
    return true;
  }

 private:
  std::span<const SeenPaint> paint_;
  double mean_, alike_;
};

double usual_level(std::span<const SeenPaint> paint) {
  std::vector<double> levels;
  for (const SeenPaint& one : paint) levels.push_back(one.level);
  return upper_median(std::move(levels));
}

BallLight told_by(const LampNumbers& numbers) {
  BallLight light{};
  light.ambient = static_cast<float>(numbers[0]);
  for (int i = 0; i < 3; ++i) light.lamp[i] = static_cast<float>(numbers[1 + i]);
  light.least = static_cast<float>(kBarePaint.least);
  return light;
}

}  // namespace

std::optional<BallLight> light_on_bare_paint(std::span<const SeenPaint> paint, double noise) {
  if (paint.size() < kBarePaint.fewest) return std::nullopt;
  const double mean = usual_level(paint);
  if (!(mean > 0)) return std::nullopt;
  const double alike = std::max(kBarePaint.alike, noise / mean);
  const LeftOfBare left(paint, mean, alike);
  using Differentiable = ceres::TinySolverAutoDiffFunction<LeftOfBare, Eigen::Dynamic, 4>;
  const Differentiable function(left);
  LampNumbers best = LampNumbers::Zero();
  double least = std::numeric_limits<double>::infinity();
  for (const double depth : kBarePaint.start_depths) {
    LampNumbers numbers(1 - 0.5 * depth, 0.05, 0.05, 0.5 * depth);
    ceres::TinySolver<Differentiable> solver;
    solver.options.max_num_iterations = 60;
    solver.Solve(function, &numbers);
    if (!(solver.summary.final_cost < least) || !numbers.allFinite()) continue;
    least = solver.summary.final_cost;
    best = numbers;
  }
  const auto is_bare = [&](const SeenPaint& one) {
    return std::abs(light_at(best.data(), one.normal) - one.level / mean) < 2 * alike;
  };
  const auto bare = std::count_if(paint.begin(), paint.end(), is_bare);
  const bool is_lit = 2 * std::hypot(best[1], best[2]) > kBarePaint.even;
  if (!is_lit || static_cast<double>(bare) < kBarePaint.share * static_cast<double>(paint.size())) {
    return std::nullopt;
  }
  return told_by(best);
}

}  // namespace impactdic::sphere
