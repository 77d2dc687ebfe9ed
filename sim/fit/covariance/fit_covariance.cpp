#include "sim/fit/covariance/fit_covariance.h"

#include <impactdic/error.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <utility>

namespace impactdic::sim::fit {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Directions of the scaled normal matrix weaker than this cannot be told from rounding.
constexpr double kSingular = 1e-8;

}  // namespace

Eigen::MatrixXd cofactor(const ShotModel& model, const std::vector<double>& values) {
  const auto size = static_cast<Eigen::Index>(model.size());
  Matrix jacobian(static_cast<Eigen::Index>(model.residuals()), size);
  std::vector<double> residual(model.residuals());
  if (!model.evaluate(values.data(), residual.data(), jacobian.data())) {
    throw Error("the fitted model has no impact", "trajectory fit");
  }
  Eigen::VectorXd scale(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    scale[i] = jacobian.col(i).norm();
    if (scale[i] > 0) jacobian.col(i) /= scale[i];
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(jacobian, Eigen::ComputeThinV);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(size, size);
  const auto& sigma = svd.singularValues();
  const double infinity = std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k < size; ++k) {
    const Eigen::VectorXd direction = svd.matrixV().col(k);
    if (sigma[k] > kSingular * sigma[0]) {
      result += direction * direction.transpose() / (sigma[k] * sigma[k]);
      continue;
    }
    for (Eigen::Index i = 0; i < size; ++i) {
      if (std::abs(direction[i]) > 1e-6) result(i, i) = infinity;
    }
  }
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j < size; ++j) {
      result(i, j) = scale[i] > 0 && scale[j] > 0 ? result(i, j) / scale[i] / scale[j]
                     : i == j                     ? infinity
                                                  : 0;
    }
  }
  return result;
}

Eigen::MatrixXd widened(const ShotModel& model, const Eigen::MatrixXd& unit, double inflation) {
  std::vector<Eigen::Index> known;
  for (std::size_t row = 0; row < model.residuals(); ++row) {
    if (model.series_of(row).kind != MeasurementKind::kPrior) continue;
    known.push_back(static_cast<Eigen::Index>(model.series_of(row).axis));
  }
  if (known.empty()) return unit * inflation;
  const Eigen::MatrixXd with = unit(Eigen::all, known);
  const Eigen::MatrixXd common =
      with * Eigen::MatrixXd(unit(known, known)).ldlt().solve(with.transpose());
  return (unit - common) * inflation + common;
}

void add_parts(ShotFit& fit, const ShotModel& model, const Eigen::MatrixXd& unit) {
  for (const auto& [source, part] :
       {std::pair{FitParameter::kScale, &ParameterEstimate::scale_part},
        std::pair{FitParameter::kRate, &ParameterEstimate::rate_part}}) {
    const std::size_t place = model.place_of(source);
    if (place < fit.parameters.size() || place == model.size()) continue;  // fitted, or exact
    const auto at = static_cast<Eigen::Index>(place);
    for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
      const double part_of = unit(static_cast<Eigen::Index>(i), at) / std::sqrt(unit(at, at));
      fit.parameters[i].*part = std::isfinite(part_of) ? part_of : 0;
    }
  }
}

}  // namespace impactdic::sim::fit
