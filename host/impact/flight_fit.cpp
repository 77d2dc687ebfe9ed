#include "host/impact/flight_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "host/base/statistics.h"
#include "host/impact/flight_data.h"

namespace impactdic::impact {
namespace {

constexpr double kOutlier = 5;   // deviations
constexpr int kFewestData = 12;  // of two flights, both axes
constexpr double kLeastSd_px = 1e-7;
// Of a sphere's turn out of the plane, in proportion: blur acts in the picture and foreshortening
// does not move it along (four patterns of R 115 px, 0.3 to 8 degrees a frame).
constexpr double kTurnModel = 2.5e-4;
// How far from a sphere's centre its circle lies by the texture under its rim. It turns along with
// the ball, and neither centres nor motions, which are about that place, tell it from a path.
constexpr double kOffsetSd_px = 0.05;
constexpr std::array kVelocities = {kVn0, kVt0, kVn1, kVt1};

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

// Less the line through them, in order.
void remove_line(std::vector<double>& values) {
  const double middle = (static_cast<double>(values.size()) - 1) / 2;
  double sum = 0, moment = 0, spread = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double x = static_cast<double>(i) - middle;
    sum += values[i], moment += x * values[i], spread += x * x;
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double x = static_cast<double>(i) - middle;
    values[i] -= sum / static_cast<double>(values.size()) + (spread > 0 ? moment / spread * x : 0);
  }
}

class FlightSolver {
 public:
  FlightSolver(const ImpactSeries& series, const GravityDirection& direction,
               std::optional<double> gravity, int flights, bool across = false)
      : series_(series),
        direction_(direction),
        gravity_(gravity),
        flights_(flights),
        across_(across) {}

  void add(const FlightRange& range, int flight) {
    const std::vector<Datum> more = flight_data(series_, direction_, range, flight);
    data_.insert(data_.end(), more.begin(), more.end());
  }

  // Of the acceleration across the direction of gravity, with `gravity` along it.
  Measured solve_across() {
    if (!solve().ok) return {};
    return {solution_[states()], std::sqrt(covariance_(states(), states()))};
  }

  FlightFit solve() {
    FlightFit fit;
    equalise();
    for (int round = 0; round < 4; ++round) {
      if (!least_squares()) return fit;
      rescale();
      if (!reject() && round > 0) break;
    }
    const double position_scale = scale_[0];
    if (series_.sphere) scale_[0] *= std::sqrt(alike_in_a_row(DatumKind::kCentre));
    if (!series_.sphere) scale_[1] *= std::sqrt(alike_in_a_row(DatumKind::kStep));
    if (!least_squares()) return fit;
    fit.ok = true;
    fit.state.head(states()) = solution_.head(states());
    fit.covariance.topLeftCorner(states(), states()) =
        covariance_.topLeftCorner(states(), states());
    if (series_.sphere) take_sphere(fit);
    take_common_part(fit);
    take_disagreement(fit);
    fit.covariance += fit.common;
    if (gravity_) fit.per_gravity.head(states()) = (-covariance_ * pull_).head(states());
    fit.gravity = gravity();
    fit.gravity_sd = gravity_ ? 0 : std::sqrt(covariance_(states(), states()));
    fit.position_scale = position_scale;
    fit.step_scale = scale_[1];
    for (const Datum& datum : data_) ++(datum.used ? fit.used : fit.rejected);
    return fit;
  }

 private:
  // The unknowns: states, gravity where it is not given, and of a sphere its radius, the circles'
  // offsets and its spins.
  int states() const { return flights_ * kStatesOfOne; }
  int radius_column() const { return states() + (gravity_ && !across_ ? 0 : 1); }
  int offset_column(int flight) const { return radius_column() + 1 + 2 * flight; }
  int spin_column(int spin) const { return offset_column(flights_) + spin; }
  int unknowns() const { return series_.sphere ? spin_column(2 * flights_) : radius_column(); }

  // Data without a stated deviation get the others' median.
  void equalise() {
    for (const DatumKind kind : {DatumKind::kCentre, DatumKind::kStep}) {
      std::vector<double> stated;
      for (const Datum& d : data_) {
        if (d.kind == kind && d.sd > kLeastSd_px) stated.push_back(d.sd);
      }
      const double usual = stated.empty() ? 1e-2 : upper_median(finite(stated));
      for (Datum& d : data_) {
        if (d.kind == kind && !(d.sd > kLeastSd_px)) d.sd = usual;
      }
    }
  }

  double gravity() const { return gravity_ ? *gravity_ : solution_[states()]; }
  double radius_error() const { return series_.sphere ? solution_[radius_column()] : 0.0; }
  double sd(const Datum& d) const { return d.sd * scale_[static_cast<std::size_t>(d.kind)]; }

  double residual(const Datum& d) const {
    double model = d.slope[0] * solution_[d.column[0]] + d.slope[1] * solution_[d.column[1]];
    model += d.gravity_slope * gravity();
    if (across_) model += d.across_slope * solution_[states()];
    if (d.spin >= 0) model += solution_[spin_column(d.spin)];
    if (!series_.sphere) return d.value - model;
    model += d.radius_slope * radius_error();
    for (std::size_t k = 0; k < 2; ++k) {
      model += d.offset_slope[k] * solution_[offset_column(d.flight) + static_cast<int>(k)];
    }
    return d.value - model;
  }

  bool least_squares() {
    const int size = unknowns();
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
        row[states()] = d.across_slope;
      } else if (!gravity_) {
        row[states()] = d.gravity_slope;
      }
      if (series_.sphere) {
        row[radius_column()] = d.radius_slope;
        row.segment<2>(offset_column(d.flight)) << d.offset_slope[0], d.offset_slope[1];
      }
      if (d.spin >= 0) row[spin_column(d.spin)] = 1;
      const double value = d.value - (gravity_ ? d.gravity_slope * *gravity_ : 0.0);
      const double weight = 1 / (sd(d) * sd(d));
      normal += weight * row * row.transpose();
      right += weight * value * row;
      pull_ += weight * d.gravity_slope * row;
      ++used;
    }
    if (used < kFewestData) return false;
    if (series_.sphere) {
      normal(radius_column(), radius_column()) += 1 / std::pow(series_.sphere->radius_sd_px(), 2);
      normal.diagonal().segment(offset_column(0), 2 * flights_).array() +=
          1 / (kOffsetSd_px * kOffsetSd_px);
    }
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
    for (const DatumKind kind : {DatumKind::kCentre, DatumKind::kStep, DatumKind::kTurn}) {
      double sum = 0, count = 0;
      for (const Datum& d : data_) {
        if (!d.used || d.kind != kind) continue;
        const double r = residual(d) / d.sd;
        sum += r * r, ++count;
      }
      double& scale = scale_[static_cast<std::size_t>(kind)];
      if (count > 0) scale = std::sqrt(sum / (count * part));
      scale = std::max(scale, 1e-6);
    }
  }

  void take_sphere(FlightFit& fit) const {
    const int spins = 2 * flights_, first = spin_column(0), radius = radius_column();
    fit.spin.head(spins) = solution_.segment(first, spins);
    fit.spin_covariance.topLeftCorner(spins, spins) = covariance_.block(first, first, spins, spins);
    for (int first_spin = 0; first_spin < spins; first_spin += 2) {
      const double model = kTurnModel * fit.spin.segment<2>(first_spin).norm();
      fit.spin_covariance.diagonal().segment<2>(first_spin).array() += model * model;
    }
    fit.radius_error = {solution_[radius], std::sqrt(covariance_(radius, radius))};
  }

  // A sphere's circle errs as its texture turns under the rim, and compressed film as its coder
  // goes on from picture to picture: alike in frames that follow each other. How many of them count
  // as one: the sum of the residuals' correlations (Sokal 1997).
  double alike_in_a_row(DatumKind kind) const {
    std::array<std::vector<double>, 4> residuals;  // by flight and axis, in order
    for (const Datum& d : data_) {
      if (!d.used || d.kind != kind) continue;
      residuals[static_cast<std::size_t>(d.column[0] / 2)].push_back(residual(d) / d.sd);
    }
    double variance = 0, sum = 0, count = 0;
    for (auto& r : residuals) {
      // What centres and steps contradict each other by is no scatter (take_disagreement).
      if (!series_.sphere) remove_line(r);
      for (const double x : r) variance += x * x, ++count;
    }
    // Of independent errors one in a thousand looks alike.
    const double least = series_.sphere ? 0.05 : 3 / std::sqrt(count);
    for (std::size_t lag = 1;; ++lag) {
      double products = 0;
      bool any = false;
      for (const auto& r : residuals) {
        for (std::size_t i = 0; i + lag < r.size(); ++i) products += r[i] * r[i + lag], any = true;
      }
      if (!any || !(products > least * variance)) break;
      sum += products / variance;
    }
    return 1 + 2 * sum;
  }

  // Data of one kind that scatter less than their deviations say are wrong by the rest of it all
  // alike: its square.
  double common_variance(DatumKind kind) const {
    std::vector<double> stated;
    for (const Datum& d : data_) {
      if (d.used && d.kind == kind) stated.push_back(d.sd);
    }
    if (series_.from_circle || stated.empty()) return 0;
    const double share = common_share(scale_[static_cast<std::size_t>(kind)], stated.size());
    const double usual = upper_median(finite(stated));
    return share * usual * usual;
  }

  void take_common_part(FlightFit& fit) const {
    const double steps = common_variance(DatumKind::kStep);
    for (const int velocity : kVelocities) fit.common(velocity, velocity) += steps;
    if (!series_.sphere) return;
    fit.spin_covariance.diagonal().array() += common_variance(DatumKind::kTurn);
  }

  // Scatter cannot show what is wrong in every frame alike: a drift of the circle, a bias of the
  // measured steps. But centres and steps give each velocity twice, independently. Where they
  // differ by more than chance (98.3 %) either may be right: the distance to the farther one, and
  // at least half of the usual difference, is a deviation more.
  void take_disagreement(FlightFit& fit) const {
    const double chance = flights_ == 2 ? 12.0 : 8.2;
    double chi_square = 0, squares = 0;
    std::array<double, kVelocities.size()> farther{};
    for (std::size_t i = 0; i < kVelocities.size(); ++i) {
      if (kVelocities[i] >= states()) break;
      const std::optional<TwoVelocities> two = two_velocities(kVelocities[i]);
      if (!two) return;
      const double off = two->of_steps - two->of_centres, both = solution_[kVelocities[i]];
      chi_square += off * off / two->chance;
      squares += std::max(0.0, off * off - two->chance);
      farther[i] = std::max(std::abs(both - two->of_steps), std::abs(both - two->of_centres));
    }
    if (!(chi_square > chance)) return;
    const int velocities = 2 * flights_;
    fit.disagreement = std::sqrt(squares / velocities);
    for (std::size_t i = 0; i < static_cast<std::size_t>(velocities); ++i) {
      const double more = std::max(farther[i], fit.disagreement / 2);
      fit.common(kVelocities[i], kVelocities[i]) += more * more;
    }
  }

  struct TwoVelocities {
    double of_steps, of_centres, chance;  // chance: variance of their difference
  };
  // Weighted mean of the steps and slope of the weighted line through the centres. What a sphere's
  // radius may do to the steps counts as chance.
  std::optional<TwoVelocities> two_velocities(int column) const {
    double step = 0, step_weight = 0, to_radius = 0;
    double w = 0, wx = 0, wxx = 0, wy = 0, wxy = 0;
    for (const Datum& d : data_) {
      if (!d.used || d.kind == DatumKind::kTurn || d.column[1] != column) continue;
      const double weight = 1 / (sd(d) * sd(d)), x = d.slope[1];
      const double y = d.value - d.gravity_slope * gravity();
      if (d.kind == DatumKind::kStep) {
        step += weight * y, step_weight += weight, to_radius += weight * d.radius_slope;
      } else {
        w += weight, wx += weight * x, wxx += weight * x * x;
        wy += weight * y, wxy += weight * x * y;
      }
    }
    const double spread = w * wxx - wx * wx;
    if (!(step_weight > 0) || !(spread > 0)) return std::nullopt;
    double chance = 1 / step_weight + w / spread;
    if (series_.sphere) {
      chance += std::pow(to_radius / step_weight * series_.sphere->radius_sd_px(), 2);
    }
    return TwoVelocities{step / step_weight, (w * wxy - wx * wy) / spread, chance};
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
  int flights_;
  bool across_;  // fits the acceleration across gravity, too
  std::vector<Datum> data_;
  std::array<double, 3> scale_ = {1, 1, 1};  // by DatumKind
  Vector solution_;
  Vector pull_;  // of gravity on the right-hand side
  Matrix covariance_;
};

}  // namespace

FlightFit fit_flights(const ImpactSeries& series, const FlightRange& before,
                      const FlightRange& after, const GravityDirection& direction,
                      std::optional<double> gravity) {
  FlightSolver solver(series, direction, gravity, 2);
  solver.add(before, 0);
  solver.add(after, 1);
  return solver.solve();
}

FlightFit fit_flight(const ImpactSeries& series, const FlightRange& range,
                     const GravityDirection& direction, std::optional<double> gravity) {
  FlightSolver solver(series, direction, gravity, 1);
  solver.add(range, 0);
  return solver.solve();
}

Measured fall_across(const ImpactSeries& series, const FlightRange& before,
                     const FlightRange& after, const GravityDirection& direction, double gravity) {
  FlightSolver solver(series, direction, gravity, 2, true);
  solver.add(before, 0);
  solver.add(after, 1);
  return solver.solve_across();
}

}  // namespace impactdic::impact
