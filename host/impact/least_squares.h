// Levenberg-Marquardt with exact derivatives: Eigen's MINPACK, Ceres's dual numbers. Internal to
// the impact analysis.
#pragma once

#include <ceres/jet.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <unsupported/Eigen/NonLinearOptimization>
#include <vector>

namespace impactdic::impact {

struct Solution {
  bool ok = false;
  Eigen::VectorXd x, sd;
  double chi_square = 0;
  int freedom = 0;
};

// Whether the misfit is what chance makes of it.
inline bool holds(const Solution& s) {
  return s.chi_square < s.freedom + 3.5 * std::sqrt(2.0 * s.freedom);
}

// `Residuals` writes `count` residuals in deviations: operator()(const T* unknowns, T* residuals)
// for T double and ceres::Jet. The unknowns are scaled to about one.
template <int kUnknowns, typename Residuals>
struct LeastSquares {
  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;
  static constexpr int InputsAtCompileTime = Eigen::Dynamic;
  static constexpr int ValuesAtCompileTime = Eigen::Dynamic;

  const Residuals& residuals;
  int count = 0;

  int inputs() const { return kUnknowns; }
  int values() const { return count; }
  int operator()(const Eigen::VectorXd& x, Eigen::VectorXd& r) const {
    if (!x.allFinite()) return -1;
    residuals(x.data(), r.data());
    return r.allFinite() ? 0 : -1;
  }
  int df(const Eigen::VectorXd& x, Eigen::MatrixXd& jacobian) const {
    using Jet = ceres::Jet<double, kUnknowns>;
    std::array<Jet, kUnknowns> at;
    for (int i = 0; i < kUnknowns; ++i) at[static_cast<std::size_t>(i)] = Jet(x[i], i);
    std::vector<Jet> r(static_cast<std::size_t>(count));
    residuals(at.data(), r.data());
    for (int i = 0; i < count; ++i) {
      jacobian.row(i) = r[static_cast<std::size_t>(i)].v.transpose();
    }
    return jacobian.allFinite() ? 0 : -1;
  }
};

// `tolerance` of the unknowns and of the sum of squares.
template <int kUnknowns, typename Residuals>
Solution solve(const Residuals& residuals, int count, Eigen::VectorXd start, double tolerance) {
  Solution solution;
  if (count <= kUnknowns) return solution;
  using Problem = LeastSquares<kUnknowns, Residuals>;
  Problem problem{residuals, count};
  Eigen::LevenbergMarquardt<Problem> search(problem);
  search.parameters.maxfev = 200;
  search.parameters.xtol = search.parameters.ftol = tolerance;
  if (search.minimize(start) == Eigen::LevenbergMarquardtSpace::UserAsked) return solution;
  Eigen::VectorXd r(count);
  Eigen::MatrixXd jacobian(count, kUnknowns);
  if (problem(start, r) != 0 || problem.df(start, jacobian) != 0) return solution;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(jacobian.transpose() * jacobian);
  if (!qr.isInvertible()) return solution;
  solution.x = start;
  solution.sd = qr.inverse().diagonal().cwiseMax(0.0).cwiseSqrt();
  solution.chi_square = r.squaredNorm();
  solution.freedom = count - kUnknowns;
  solution.ok = solution.sd.allFinite();
  return solution;
}

}  // namespace impactdic::impact
