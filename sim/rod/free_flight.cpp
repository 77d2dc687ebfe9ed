#include "sim/rod/free_flight.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "host/base/statistics.h"

namespace impactdic::sim::rod {
namespace {

constexpr double kOutOfFlight_sd = 5;

}  // namespace

double PolynomialFit::at(double time_s) const {
  double sum = 0;
  for (std::size_t i = coefficients.size(); i-- > 0;) {
    sum = sum * (time_s - reference_s) + coefficients[i];
  }
  return sum;
}

double PolynomialFit::slope_at(double time_s) const {
  double sum = 0;
  for (std::size_t i = coefficients.size(); i-- > 1;) {
    sum = sum * (time_s - reference_s) + static_cast<double>(i) * coefficients[i];
  }
  return sum;
}

double PolynomialFit::leverage(double time_s) const {
  double sum = 0, row = 1;
  for (std::size_t i = 0; i < coefficients.size(); ++i, row *= time_s - reference_s) {
    double column = 1;
    for (std::size_t j = 0; j < coefficients.size(); ++j, column *= time_s - reference_s) {
      sum += row * column * cofactor_at(i, j);
    }
  }
  return sum;
}

PolynomialFit fit_polynomial(const std::vector<double>& time_s, const std::vector<double>& value,
                             std::size_t first, std::size_t last, std::size_t degree,
                             double reference_s) {
  const auto columns = static_cast<Eigen::Index>(degree + 1);
  PolynomialFit result;
  result.reference_s = reference_s;
  result.coefficients.assign(degree + 1, 0.0);
  result.cofactor.assign((degree + 1) * (degree + 1), 0.0);
  std::vector<std::size_t> frames;
  for (std::size_t i = first; i <= last; ++i) {
    if (!std::isnan(value[i])) frames.push_back(i);
  }
  result.count = frames.size();
  if (result.count < degree + 1) return result;
  // Time in units of the span keeps the powers alike.
  const double span = std::max(
      {std::abs(time_s[first] - reference_s), std::abs(time_s[last] - reference_s), 1e-300});
  Eigen::MatrixXd design(static_cast<Eigen::Index>(frames.size()), columns);
  Eigen::VectorXd target(design.rows());
  for (Eigen::Index i = 0; i < design.rows(); ++i) {
    const std::size_t frame = frames[static_cast<std::size_t>(i)];
    double power = 1;
    for (Eigen::Index j = 0; j < columns; ++j) {
      design(i, j) = power;
      power *= (time_s[frame] - reference_s) / span;
    }
    target[i] = value[frame];
  }
  const Eigen::VectorXd solution = design.colPivHouseholderQr().solve(target);
  const Eigen::MatrixXd normal = design.transpose() * design;
  const Eigen::MatrixXd cofactor = normal.ldlt().solve(Eigen::MatrixXd::Identity(columns, columns));
  for (Eigen::Index i = 0; i < columns; ++i) {
    const double scale = std::pow(span, -static_cast<double>(i));
    result.coefficients[static_cast<std::size_t>(i)] = solution[i] * scale;
    for (Eigen::Index j = 0; j < columns; ++j) {
      result.cofactor[static_cast<std::size_t>(i * columns + j)] =
          cofactor(i, j) * scale * std::pow(span, -static_cast<double>(j));
    }
  }
  const double freedom = std::max<double>(1, static_cast<double>(design.rows() - columns));
  result.rms = (design * solution - target).norm() / std::sqrt(freedom);
  return result;
}

double frame_noise(const std::vector<double>& value, double least) {
  std::vector<double> third;
  for (std::size_t i = 3; i < value.size(); ++i) {
    const double d = value[i] - 3 * value[i - 1] + 3 * value[i - 2] - value[i - 3];
    if (!std::isnan(d)) third.push_back(std::abs(d));
  }
  if (third.empty()) return least;
  return std::max(least, upper_median(std::move(third)) / 0.6745 / std::sqrt(20.0));
}

bool FreeFlight::continues(std::size_t first, std::size_t last, std::size_t frame) const {
  return std::all_of(channels_.begin(), channels_.end(), [&](const FlightChannel& channel) {
    if (std::isnan(channel.value[frame])) return true;
    const PolynomialFit line =
        fit_polynomial(time_s_, channel.value, first, last, 1, time_s_[frame]);
    if (line.count < 3) return false;
    const double spread = channel.noise * std::sqrt(1 + line.leverage(time_s_[frame]));
    return std::abs(channel.value[frame] - line.at(time_s_[frame])) <= kOutOfFlight_sd * spread;
  });
}

void FreeFlight::widen_down(std::size_t& first, std::size_t last, std::size_t lowest) const {
  while (first > lowest && continues(first, last, first - 1)) --first;
}

void FreeFlight::widen_up(std::size_t first, std::size_t& last, std::size_t highest) const {
  while (last < highest && continues(first, last, last + 1)) ++last;
}

}  // namespace impactdic::sim::rod
