#include "host/impact/flight_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "host/base/statistics.h"
#include "host/impact/flight/flat_links.h"
#include "host/impact/flight/flight_data.h"
#include "host/impact/flight/flight_links.h"
#include "host/impact/flight/row_groups.h"
#include "host/impact/flight/unknowns.h"
#include "host/impact/flight/velocity_sums.h"

namespace impactdic::impact {
namespace {

constexpr double kOutlier = 5;   // deviations
constexpr int kFewestData = 12;  // of two flights, both axes
// Of a sphere's turn out of the plane, in proportion: blur acts in the picture and foreshortening
// does not move it along (four patterns of R 115 px, 0.3 to 8 degrees a frame).
constexpr double kTurnModel = 2.5e-4;
// Of the centre, in proportion to the rim's speed (sixteen flights of four patterns, R 115 px).
constexpr double kLinkedCentreModel = 6e-6;
// A flat ball's steps that scatter by less than this share of what they state have much alike.
constexpr double kMuchMore = 0.5;
constexpr double kSlowed = 5;  // deviations beyond which a mean of steps is off
constexpr std::array kVelocities = {kVn0, kVt0, kVn1, kVt1};

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

class FlightSolver {
 public:
  FlightSolver(const ImpactSeries& series, const GravityDirection& direction,
               std::optional<double> gravity, const std::vector<FlightRange>& ranges,
               bool across = false)
      : series_(series),
        direction_(direction),
        gravity_(gravity),
        ranges_(ranges),
        flights_(static_cast<int>(ranges.size())),
        unknowns_(flights_, series.sphere.has_value(), !gravity || across, across) {
    for (int flight = 0; flight < flights_; ++flight) {
      const FlightRange& range = ranges[static_cast<std::size_t>(flight)];
      std::vector<Datum> more = flight_data(series_, direction_, range, flight);
      if (is_borne(series_, ranges_, flight)) take_weight_off(more);
      data_.insert(data_.end(), more.begin(), more.end());
    }
    if (series_.sphere) add_links();
  }

  // Of the acceleration across the direction of gravity, with `gravity` along it.
  Measured solve_across() {
    if (!solve().ok) return {};
    return {solution_[unknowns_.states()],
            std::sqrt(covariance_(unknowns_.states(), unknowns_.states()))};
  }

  FlightFit solve() {
    FlightFit fit;
    give_usual_deviations(data_);
    if (!settle()) return fit;
    if (!series_.sphere && !settle_on_links()) return fit;
    const double position_scale = scale_[0];
    count_alike();
    if (!least_squares()) return fit;
    const int n = unknowns_.states();
    const Matrix alone = covariance_.topLeftCorner(n, n);
    if (let_steps_lean() && !least_squares()) return fit;
    fit.ok = true;
    fit.state.head(n) = solution_.head(n);
    fit.covariance.topLeftCorner(n, n) = alone;
    fit.common.topLeftCorner(n, n) = covariance_.topLeftCorner(n, n) - alone;
    if (series_.sphere) take_sphere(fit);
    take_common_part(fit);
    take_disagreement(fit);
    fit.covariance += fit.common;
    if (gravity_) fit.per_gravity.head(n) = (-covariance_ * pull_).head(n);
    fit.gravity = gravity();
    fit.gravity_sd = gravity_ ? 0 : std::sqrt(covariance_(n, n));
    fit.position_scale = position_scale;
    fit.step_scale = scale_[1];
    for (const Datum& datum : data_) {
      if (datum.fitted) ++(datum.used ? fit.used : fit.rejected);
    }
    return fit;
  }

 private:
  // Fits, learns what the data scatter by and leaves out what lies far off, in turns.
  bool settle() {
    for (int round = 0; round < 4; ++round) {
      if (!least_squares()) return false;
      rescale();
      if (!reject() && round > 0) break;
    }
    return true;
  }
  double scale(DatumKind kind) const { return scale_[static_cast<std::size_t>(kind)]; }

  // What errs alike in frames that follow each other counts for fewer. What centres scatter less
  // than is stated may turn along with the texture under the rim.
  void count_alike() {
    const bool linked = unknowns_.is_linked();
    if (series_.sphere || linked) scale_[0] = std::max(scale_[0], 1.0);
    const std::vector<double> all = residuals();
    if (series_.sphere || linked) count_alike(DatumKind::kCentre, all, true);
    if (series_.sphere) return;
    count_alike(DatumKind::kStep, all, false);
    if (linked) count_alike(DatumKind::kShift, own_residuals(data_, all), false);
  }
  void count_alike(DatumKind kind, const std::vector<double>& residuals, bool sphere) {
    scale_[static_cast<std::size_t>(kind)] *=
        std::sqrt(alike_in_a_row(data_, residuals, kind, sphere));
  }

  // Registrations against keyframes take the place of steps and turns where all flights have them.
  void add_links() {
    std::vector<Datum> links;
    for (int flight = 0; flight < flights_; ++flight) {
      std::vector<Datum> more =
          flight_links(series_, direction_, ranges_[static_cast<std::size_t>(flight)], flight,
                       static_cast<int>(links.size()));
      if (more.empty()) return;
      if (is_borne(series_, ranges_, flight)) take_weight_off(more);
      links.insert(links.end(), more.begin(), more.end());
    }
    unknowns_.link();
    for (int flight = 0; !series_.sphere && flight < flights_; ++flight) {
      unknowns_.follow(flight, followed_sd(series_, ranges_[static_cast<std::size_t>(flight)]));
    }
    for (Datum& d : data_) d.fitted = d.kind == DatumKind::kCentre;
    data_.insert(data_.end(), links.begin(), links.end());
  }

  // A flat ball's places on keyframes instead of its steps, where they say more. Where they say
  // something else a pattern that stands still slows steps, and places near a keyframe.
  bool settle_on_links() {
    // Poses, too, would add up a turn out of the picture's plane that nobody sees.
    if (!(scatter_about_means(data_, residuals(), DatumKind::kStep) > kMuchMore)) return true;
    add_links();
    if (!unknowns_.is_linked()) return true;
    if (!settle()) return false;
    const double off = farthest_mean(data_, residuals(), DatumKind::kStep, kSlowed);
    if (!(off > 0)) return true;
    leaning_px2_ = std::pow(off * usual_deviation(data_, DatumKind::kStep), 2);
    unknowns_.unlink();
    std::erase_if(data_, [](const Datum& d) { return d.kind == DatumKind::kShift; });
    for (Datum& d : data_) d.fitted = d.used = true;
    return settle();
  }

  // Whether the row counts in the fit.
  static bool counts(const Datum& d) { return d.fitted && d.used; }

  double gravity() const { return gravity_ ? *gravity_ : solution_[unknowns_.states()]; }
  double radius_error() const { return series_.sphere ? solution_[unknowns_.radius()] : 0.0; }
  double sd(const Datum& d) const { return d.sd * scale(d.kind); }

  double value(const Datum& d) const {
    return d.value - (gravity_ ? d.gravity_slope * *gravity_ : 0.0);
  }
  double residual(const Datum& d) const { return value(d) - unknowns_.row_of(d).dot(solution_); }

  bool least_squares() {
    const int size = unknowns_.count();
    Matrix normal = Matrix::Zero(size, size);
    Vector right = Vector::Zero(size);
    pull_ = Vector::Zero(size);
    int used = 0;
    RowGroups groups;
    for (const Datum& d : data_) {
      if (!counts(d)) continue;
      const Vector row = unknowns_.row_of(d) / sd(d);
      const double seen = value(d) / sd(d), gravity = d.gravity_slope / sd(d);
      normal += row * row.transpose();
      right += seen * row;
      pull_ += gravity * row;
      if (d.group >= 0) groups.add(d, row, seen, gravity);
      ++used;
    }
    groups.take_off(normal, right, pull_);
    if (used < kFewestData) return false;
    unknowns_.add_priors(series_, usual_deviation(data_, DatumKind::kCentre), normal);
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
    const auto used = static_cast<double>(std::count_if(data_.begin(), data_.end(), counts));
    const double part = 1 - static_cast<double>(solution_.size()) / used;
    std::array<double, kDatumKinds> sums{}, numbers{};
    const std::vector<double> all = residuals(), own = own_residuals(data_, all);
    for (std::size_t i = 0; i < data_.size(); ++i) {
      if (!data_[i].used) continue;
      const auto kind = static_cast<std::size_t>(data_[i].kind);
      sums[kind] += all[i] * own[i];
      ++numbers[kind];
    }
    for (std::size_t kind = 0; kind < kDatumKinds; ++kind) {
      if (numbers[kind] > 0) scale_[kind] = std::sqrt(sums[kind] / (numbers[kind] * part));
      scale_[kind] = std::max(scale_[kind], 1e-6);
    }
  }
  // Over what is stated.
  std::vector<double> residuals() const {
    std::vector<double> all;
    for (const Datum& d : data_) all.push_back(residual(d) / d.sd);
    return all;
  }

  void take_sphere(FlightFit& fit) const {
    const int radius = unknowns_.radius();
    for (int flight = 0; flight < flights_; ++flight) {
      const int from = unknowns_.spin(flight), to = 2 * flight;
      fit.spin.segment<2>(to) = solution_.segment<2>(from);
      for (int other = 0; other < flights_; ++other) {
        fit.spin_covariance.block<2, 2>(to, 2 * other) =
            covariance_.block<2, 2>(from, unknowns_.spin(other));
      }
      const double tilting = fit.spin.segment<2>(to).norm();
      if (!unknowns_.is_linked()) {
        fit.spin_covariance.diagonal().segment<2>(to).array() += std::pow(kTurnModel * tilting, 2);
        continue;
      }
      fit.roll[static_cast<std::size_t>(flight)] = {solution_[from + 2],
                                                    std::sqrt(covariance_(from + 2, from + 2))};
      const double rim = kLinkedCentreModel * tilting * series_.sphere->radius_px();
      for (const int velocity : {kVn0, kVt0}) {
        const int column = kStatesOfOne * flight + velocity;
        fit.common(column, column) += rim * rim;
      }
    }
    fit.radius_error = {solution_[radius], std::sqrt(covariance_(radius, radius))};
  }

  // Data of one kind that scatter less than their deviations say are wrong by the rest of it all
  // alike: its square.
  double common_variance(DatumKind kind) const {
    if (series_.from_circle) return 0;
    const auto count = std::count_if(data_.begin(), data_.end(),
                                     [&](const Datum& d) { return d.used && d.kind == kind; });
    if (count == 0) return 0;
    const double share = common_share(scale(kind), static_cast<std::size_t>(count));
    return share * std::pow(usual_deviation(data_, kind), 2);
  }

  // A flat ball's steps that state much more than they scatter by may all be off by the rest of
  // it, as by a turn out of the picture's plane that nobody sees; or they are slowed. Centres tell
  // by how much, as independent as they are of each other. Whether it is so.
  bool let_steps_lean() {
    const double scatter = scale(DatumKind::kStep);
    if (series_.sphere || unknowns_.is_linked()) return false;
    if (scatter < kMuchMore) {
      leaning_px2_ = std::max(leaning_px2_, common_variance(DatumKind::kStep));
    }
    if (!(leaning_px2_ > 0)) return false;
    scale_[0] = std::max(scale_[0], 1.0) *
                std::sqrt(alike_in_a_row(data_, residuals(), DatumKind::kCentre, true));
    lean(data_, DatumKind::kStep, std::sqrt(leaning_px2_), scatter);
    return true;
  }

  void take_common_part(FlightFit& fit) const {
    if (unknowns_.is_linked() && !series_.sphere) take_drift(fit);
    if (unknowns_.is_linked() || leaning_px2_ > 0) return;
    const double steps = common_variance(DatumKind::kStep);
    for (const int velocity : kVelocities) fit.common(velocity, velocity) += steps;
    if (!series_.sphere) return;
    fit.spin_covariance.diagonal().array() += common_variance(DatumKind::kTurn);
  }

  // The bias of the interpolation goes along with the fraction of a pixel, and with the ball's
  // turn.
  void take_drift(FlightFit& fit) const {
    const double drift_px = usual_deviation(data_, DatumKind::kShift) * scale(DatumKind::kShift);
    for (int flight = 0; flight < flights_; ++flight) {
      const FlightRange& range = ranges_[static_cast<std::size_t>(flight)];
      const double by_frame = kLinkDrift * drift_px / static_cast<double>(range.last - range.first);
      for (const int velocity : {kVn0, kVt0}) {
        const int column = kStatesOfOne * flight + velocity;
        fit.common(column, column) += by_frame * by_frame;
      }
    }
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
      if (kVelocities[i] >= unknowns_.states()) break;
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
    double of_steps, of_centres;
    double chance;  // variance of their difference, what a sphere's radius may do to steps included
  };
  std::optional<TwoVelocities> two_velocities(int column) const {
    VelocitySums sums;
    for (const Datum& d : data_) {
      const int place = kStatesOfOne * d.flight + (d.normal ? kN0 : kT0);
      if (!d.used || place + 1 != column) continue;
      sums.add(d, sd(d), d.value - d.gravity_slope * gravity());
    }
    if (!sums.tell_both()) return std::nullopt;
    // Keyframes tell no velocity apart from all the rest.
    const double of_centres = sums.slope_of_centres(), variance = sums.variance_of_slope();
    if (unknowns_.is_linked()) return TwoVelocities{solution_[column], of_centres, variance};
    double chance = 1 / sums.steps + leaning_px2_ + variance;
    if (series_.sphere) {
      chance += std::pow(sums.to_radius / sums.steps * series_.sphere->radius_sd_px(), 2) +
                std::pow(sums.to_nearness / sums.steps * series_.sphere->nearness_sd(), 2);
    }
    return TwoVelocities{sums.step / sums.steps, of_centres, chance};
  }

  bool reject() {
    std::vector<double> sizes;
    const std::vector<double> own = own_residuals(data_, residuals());
    for (std::size_t i = 0; i < data_.size(); ++i) {
      sizes.push_back(std::abs(own[i]) / scale(data_[i].kind));
    }
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
  std::vector<FlightRange> ranges_;
  int flights_;
  Unknowns unknowns_;
  std::vector<Datum> data_;
  std::array<double, kDatumKinds> scale_ = {1, 1, 1, 1, 1, 1};
  double leaning_px2_ = 0;  // variance of what all steps of a flight may be off by
  Vector solution_;
  Vector pull_;  // of gravity on the right-hand side
  Matrix covariance_;
};

}  // namespace

FlightFit fit_flights(const ImpactSeries& series, const FlightRange& before,
                      const FlightRange& after, const GravityDirection& direction,
                      std::optional<double> gravity) {
  return FlightSolver(series, direction, gravity, {before, after}).solve();
}

FlightFit fit_flight(const ImpactSeries& series, const FlightRange& range,
                     const GravityDirection& direction, std::optional<double> gravity) {
  return FlightSolver(series, direction, gravity, {range}).solve();
}

Measured fall_across(const ImpactSeries& series, const FlightRange& before,
                     const FlightRange& after, const GravityDirection& direction, double gravity) {
  return FlightSolver(series, direction, gravity, {before, after}, true).solve_across();
}

}  // namespace impactdic::impact
