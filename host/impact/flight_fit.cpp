#include "host/impact/flight_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "host/base/statistics.h"

namespace impactdic::impact {
namespace {

constexpr int kGravityColumn = kFlightStates;
constexpr double kOutlier = 5;   // deviations
constexpr int kFewestData = 12;  // of two flights, both axes
constexpr double kLeastSd_px = 1e-7;
constexpr std::array kVelocities = {kVn0, kVt0, kVn1, kVt1};

struct Datum {
  std::array<int, 2> column;    // of the state: position and velocity
  std::array<double, 2> slope;  // what they contribute
  double gravity_slope, across_slope;
  double value, sd;
  bool is_step;
  bool used = true;
};

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

class FlightSolver {
 public:
  FlightSolver(const ImpactSeries& series, const GravityDirection& direction,
               std::optional<double> gravity, bool across = false)
      : series_(series), direction_(direction), gravity_(gravity), across_(across) {}

  void add(const FlightRange& range, int first_column) {
    for (std::size_t i = range.first; i <= range.last; ++i) {
      const double from = static_cast<double>(i) - range.at;
      for (const bool normal : {true, false}) {
        const int column = first_column + (normal ? 0 : 2);
        const double pull = normal ? direction_.n : direction_.t;
        const double across = normal ? direction_.t : -direction_.n;
        const double centre = normal ? series_.position_n[i] : series_.position_t[i];
        const double step = normal ? series_.step_n[i] : series_.step_t[i];
        add({{column, column + 1},
             {1, from},
             pull * from * from / 2,
             across * from * from / 2,
             centre,
             series_.position_sd[i],
             false});
        if (i == range.last || series_.from_circle) continue;
        add({{column, column + 1},
             {0, 1},
             pull * (from + 0.5),
             across * (from + 0.5),
             step,
             series_.step_sd[i],
             true});
      }
    }
  }

  // Of the acceleration across the direction of gravity, with `gravity` along it.
  Measured solve_across() {
    if (!solve().ok) return {};
    return {solution_[kGravityColumn], std::sqrt(covariance_(kGravityColumn, kGravityColumn))};
  }

  FlightFit solve() {
    FlightFit fit;
    equalise();
    for (int round = 0; round < 4; ++round) {
      if (!least_squares()) return fit;
      rescale();
      if (!reject() && round > 0) break;
    }
    if (!least_squares()) return fit;
    fit.ok = true;
    fit.state = solution_.head<kFlightStates>();
    fit.covariance = covariance_.topLeftCorner<kFlightStates, kFlightStates>();
    take_common_part(fit);
    take_disagreement(fit);
    fit.covariance += fit.common;
    if (gravity_) fit.per_gravity = (-covariance_ * pull_).head<kFlightStates>();
    fit.gravity = gravity();
    fit.gravity_sd = gravity_ ? 0 : std::sqrt(covariance_(kGravityColumn, kGravityColumn));
    fit.position_scale = scale_[0];
    fit.step_scale = scale_[1];
    for (const Datum& datum : data_) ++(datum.used ? fit.used : fit.rejected);
    return fit;
  }

 private:
  void add(const Datum& datum) {
    if (std::isfinite(datum.value)) data_.push_back(datum);
  }

  // Data without a stated deviation get the others' median.
  void equalise() {
    for (const bool steps : {false, true}) {
      std::vector<double> stated;
      for (const Datum& d : data_) {
        if (d.is_step == steps && d.sd > kLeastSd_px) stated.push_back(d.sd);
      }
      const double usual = stated.empty() ? 1e-2 : upper_median(finite(stated));
      for (Datum& d : data_) {
        if (d.is_step == steps && !(d.sd > kLeastSd_px)) d.sd = usual;
      }
    }
  }

  double gravity() const { return gravity_ ? *gravity_ : solution_[kGravityColumn]; }
  double sd(const Datum& d) const { return d.sd * scale_[d.is_step ? 1 : 0]; }

  double residual(const Datum& d) const {
    double model = d.slope[0] * solution_[d.column[0]] + d.slope[1] * solution_[d.column[1]];
    model += d.gravity_slope * gravity();
    if (across_) model += d.across_slope * solution_[kGravityColumn];
    return d.value - model;
  }

  bool least_squares() {
    const int size = kFlightStates + (gravity_ && !across_ ? 0 : 1);
    Matrix normal = Matrix::Zero(size, size);
    Vector right = Vector::Zero(size);
    pull_ = Vector::Zero(size);
    int used = 0;
    for (const Datum& d : data_) {
      if (!d.used) continue;
      Vector row = Vector::Zero(size);
      row[d.column[0]] = d.slope[0];
      row[d.column[1]] = d.slope[1];
      if (across_) {
        row[kGravityColumn] = d.across_slope;
      } else if (!gravity_) {
        row[kGravityColumn] = d.gravity_slope;
      }
      const double value = d.value - (gravity_ ? d.gravity_slope * *gravity_ : 0.0);
      const double weight = 1 / (sd(d) * sd(d));
      normal += weight * row * row.transpose();
      right += weight * value * row;
      pull_ += weight * d.gravity_slope * row;
      ++used;
    }
    if (used < kFewestData) return false;
    const Vector diagonal = normal.diagonal().cwiseSqrt();
    if (!(diagonal.minCoeff() > 0)) return false;
    const Matrix scaled =
        diagonal.cwiseInverse().asDiagonal() * normal * diagonal.cwiseInverse().asDiagonal();
    const Eigen::LDLT<Matrix> decomposition(scaled);
    if (decomposition.info() != Eigen::Success || !(decomposition.rcond() > 1e-13)) return false;
    const Matrix inverse = decomposition.solve(Matrix::Identity(size, size));
    covariance_ =
        diagonal.cwiseInverse().asDiagonal() * inverse * diagonal.cwiseInverse().asDiagonal();
    solution_ = covariance_ * right;
    return solution_.allFinite();
  }

  // Scatter over stated deviation, of centres and of steps; each kind pays for its share of the
  // unknowns.
  void rescale() {
    const double used = static_cast<double>(
        std::count_if(data_.begin(), data_.end(), [](const Datum& d) { return d.used; }));
    const double part = 1 - static_cast<double>(solution_.size()) / used;
    for (const int kind : {0, 1}) {
      double sum = 0, count = 0;
      for (const Datum& d : data_) {
        if (!d.used || d.is_step != (kind == 1)) continue;
        const double r = residual(d) / d.sd;
        sum += r * r, ++count;
      }
      if (count > 0) scale_[static_cast<std::size_t>(kind)] = std::sqrt(sum / (count * part));
      scale_[static_cast<std::size_t>(kind)] =
          std::max(scale_[static_cast<std::size_t>(kind)], 1e-6);
    }
  }

  // Steps that scatter less than their deviations say are wrong by the rest of it all alike.
  void take_common_part(FlightFit& fit) const {
    std::vector<double> stated;
    for (const Datum& d : data_) {
      if (d.used && d.is_step) stated.push_back(d.sd);
    }
    if (series_.from_circle || stated.empty()) return;
    const double share = common_share(scale_[1], stated.size());
    const double usual = upper_median(finite(stated));
    for (const int velocity : kVelocities) {
      fit.common(velocity, velocity) += share * usual * usual;
    }
  }

  // Scatter cannot show what is wrong in every frame alike: a drift of the circle, a bias of the
  // measured steps. But centres and steps give each velocity twice, independently. Where they
  // differ by more than chance (98.3 %) either may be right: the distance to the farther one, and
  // at least half of the usual difference, is a deviation more.
  void take_disagreement(FlightFit& fit) const {
    constexpr double kChance = 12.0;
    double chi_square = 0, squares = 0;
    std::array<double, kVelocities.size()> farther{};
    for (std::size_t i = 0; i < kVelocities.size(); ++i) {
      const std::optional<TwoVelocities> two = two_velocities(kVelocities[i]);
      if (!two) return;
      const double off = two->of_steps - two->of_centres, both = solution_[kVelocities[i]];
      chi_square += off * off / two->chance;
      squares += std::max(0.0, off * off - two->chance);
      farther[i] = std::max(std::abs(both - two->of_steps), std::abs(both - two->of_centres));
    }
    if (!(chi_square > kChance)) return;
    fit.disagreement = std::sqrt(squares / static_cast<double>(kVelocities.size()));
    for (std::size_t i = 0; i < kVelocities.size(); ++i) {
      const double more = std::max(farther[i], fit.disagreement / 2);
      fit.common(kVelocities[i], kVelocities[i]) += more * more;
    }
  }

  struct TwoVelocities {
    double of_steps, of_centres, chance;  // chance: variance of their difference
  };
  // Weighted mean of the steps and slope of the weighted line through the centres.
  std::optional<TwoVelocities> two_velocities(int column) const {
    double step = 0, step_weight = 0;
    double w = 0, wx = 0, wxx = 0, wy = 0, wxy = 0;
    for (const Datum& d : data_) {
      if (!d.used || d.column[1] != column) continue;
      const double weight = 1 / (sd(d) * sd(d)), x = d.slope[1];
      const double y = d.value - d.gravity_slope * gravity();
      if (d.is_step) {
        step += weight * y, step_weight += weight;
      } else {
        w += weight, wx += weight * x, wxx += weight * x * x;
        wy += weight * y, wxy += weight * x * y;
      }
    }
    const double spread = w * wxx - wx * wx;
    if (!(step_weight > 0) || !(spread > 0)) return std::nullopt;
    return TwoVelocities{step / step_weight, (w * wxy - wx * wy) / spread,
                         1 / step_weight + w / spread};
  }

  bool reject() {
    std::vector<double> sizes;
    for (const Datum& d : data_) sizes.push_back(std::abs(residual(d)) / sd(d));
    const double limit = kOutlier * std::max(kSdOfMad * upper_median(finite(sizes)), 1e-9);
    bool changed = false;
    for (std::size_t i = 0; i < data_.size(); ++i) {
      const bool use = sizes[i] <= limit;
      changed |= use != data_[i].used;
      data_[i].used = use;
    }
    return changed;
  }

  const ImpactSeries& series_;
  GravityDirection direction_;
  std::optional<double> gravity_;
  bool across_;  // fits the acceleration across gravity, too
  std::vector<Datum> data_;
  std::array<double, 2> scale_ = {1, 1};
  Vector solution_;
  Vector pull_;  // of gravity on the right-hand side
  Matrix covariance_;
};

}  // namespace

FlightFit fit_flights(const ImpactSeries& series, const FlightRange& before,
                      const FlightRange& after, const GravityDirection& direction,
                      std::optional<double> gravity) {
  FlightSolver solver(series, direction, gravity);
  solver.add(before, kN0);
  solver.add(after, kN1);
  return solver.solve();
}

Measured fall_across(const ImpactSeries& series, const FlightRange& before,
                     const FlightRange& after, const GravityDirection& direction, double gravity) {
  FlightSolver solver(series, direction, gravity, true);
  solver.add(before, kN0);
  solver.add(after, kN1);
  return solver.solve_across();
}

}  // namespace impactdic::impact
