#include "host/impact/evidence/path_fits.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "host/base/statistics.h"
#include "host/impact/evidence/contact_guess.h"

namespace impactdic::impact {
namespace {

constexpr double kOff = 8;  // deviations of the noise beyond which a single frame is bad
constexpr double kLeastScatter = 1e-7;  // px

// The sum of the residuals' correlations, at least 1: by pairs of lags as long as these are
// positive beyond chance (Geyer 1992, section 3.3), since coders err in turns from frame to frame.
double alike(const std::vector<double>& left, double squares) {
  const double chance = 2 * std::sqrt(2 / static_cast<double>(left.size()));
  const auto correlation = [&](std::size_t lag) {
    double products = 0;
    for (std::size_t i = 0; i + lag < left.size(); ++i) products += left[i] * left[i + lag];
    return products / squares;
  };
  double sum = 2 * correlation(1) + 1;
  for (std::size_t lag = 2; lag + 1 < left.size() / 2; lag += 2) {
    const double pair = correlation(lag) + correlation(lag + 1);
    if (!(pair > chance)) break;
    sum += 2 * pair;
  }
  return std::max(sum, 1.0);
}

// Whether the first or last value lies off the line and the parabola that the three beside it make.
bool is_off_end(const std::vector<double>& values, std::size_t i, double limit) {
  if (i != 0 && i + 1 != values.size()) return false;
  const auto beside = [&](std::size_t k) { return values[i == 0 ? k : i - k]; };
  const double line = 2 * beside(1) - beside(2);
  const double parabola = line + beside(1) - 2 * beside(2) + beside(3);
  return std::abs(values[i] - line) > limit && std::abs(values[i] - parabola) > limit;
}

}  // namespace

void PathFits::add(const std::vector<double>& all, const PathSpan& span, Kind kind) {
  const std::size_t end = std::min(all.size(), span.end + (kind == kPlace ? 1 : 0));
  if (span.begin + 5 > end) return;
  const std::vector<double> values(all.begin() + static_cast<std::ptrdiff_t>(span.begin),
                                   all.begin() + static_cast<std::ptrdiff_t>(end));
  const double limit = kOff * noise_of(values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t from = std::min(i - std::min<std::size_t>(i, 2), values.size() - 5);
    const auto near = values.begin() + static_cast<std::ptrdiff_t>(from);
    const double middle = upper_median(finite({near, near + 5}));
    // A path bends within the five frames, at their ends more.
    const bool inner = i >= 2 && i + 2 < values.size();
    if (!std::isfinite(values[i]) || (inner && std::abs(values[i] - middle) > limit)) continue;
    if (is_off_end(values, i, limit)) continue;
    samples_.push_back({static_cast<double>(span.begin + i), values[i], kind});
  }
}

PathFits::PathFits(const ImpactSeries& series, const PathSpan& span, double least_px,
                   PathSource source)
    : least_px_(std::max(least_px, kLeastScatter)) {
  const bool with_centres = source == PathSource::kCentresAndSteps || series.from_circle;
  if (with_centres) add(series.position_n, span, kPlace);
  if (!series.from_circle) add(series.step_n, span, kStep);
  for (const Sample& s : samples_) ++count_[s.kind];
  scale_[kPlace] = noise_of(series.position_n);
  scale_[kStep] = noise_of(series.step_n);
  for (double& scale : scale_) scale = scale > least_px_ ? scale : least_px_;
  for (std::size_t i = span.begin; i <= span.end; ++i) {
    instants_.push_back(static_cast<double>(i));
  }
}

PathFit PathFits::fit(const Basis& basis, int more) const {
  const Equations e = equations(basis);
  const Eigen::VectorXd solution = e.scale.asDiagonal() * e.normal.ldlt().solve(e.right);
  PathFit fit;
  fit.residuals = e.values - e.slopes * solution;
  fit.score = score(fit.residuals.squaredNorm(), basis.size(), more);
  return fit;
}

std::vector<double> PathFits::scores(const Basis& basis, std::size_t fewest, std::size_t step,
                                     int more) const {
  const Equations e = equations(basis);
  const Eigen::VectorXd parts = e.normal.llt().matrixL().solve(e.right);
  double squares = e.values.squaredNorm();
  std::vector<double> found;
  for (std::size_t k = 1; k <= basis.size(); ++k) {
    squares -= std::pow(parts[static_cast<Eigen::Index>(k) - 1], 2);
    if (k >= fewest && (k - fewest) % step == 0) found.push_back(score(squares, k, more));
  }
  return found;
}

void PathFits::take_scatter(const PathFit& fit, const PathSpan& span) {
  for (const Kind kind : {kPlace, kStep}) {
    std::vector<double> left, all;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const Sample& s = samples_[i];
      const bool in =
          s.at > static_cast<double>(span.first) - 2 && s.at < static_cast<double>(span.last) + 2;
      if (s.kind != kind) continue;
      all.push_back(fit.residuals[static_cast<int>(i)] * sd(kind));
      if (!in) left.push_back(all.back());
    }
    // A few frames at the ends tell neither what scatters nor for how long.
    if (left.size() < all.size() / 2) left = std::move(all);
    if (left.size() < 6) continue;
    double squares = 0;
    for (const double r : left) squares += r * r;
    scale_[kind] = std::max(std::sqrt(squares / static_cast<double>(left.size())), least_px_);
    alike_[kind] = alike(left, squares);
  }
}

PathFits::Equations PathFits::equations(const Basis& basis) const {
  const auto rows = static_cast<Eigen::Index>(samples_.size());
  const auto columns = static_cast<Eigen::Index>(basis.size());
  Equations e{Eigen::MatrixXd(rows, columns), {}, Eigen::VectorXd(rows), {}, {}};
  const std::array<double, kKinds> weight = {1 / sd(kPlace), 1 / sd(kStep)};
  std::vector<double> places(instants_.size());  // places and steps share their instants
  for (Eigen::Index k = 0; k < columns; ++k) {
    std::transform(instants_.begin(), instants_.end(), places.begin(),
                   basis[static_cast<std::size_t>(k)]);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const Sample& s = samples_[static_cast<std::size_t>(i)];
      const auto at = static_cast<std::size_t>(s.at - instants_.front());
      const double place = s.kind == kPlace ? places[at] : places[at + 1] - places[at];
      e.slopes(i, k) = weight[s.kind] * place;
    }
  }
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Sample& s = samples_[static_cast<std::size_t>(i)];
    e.values[i] = s.value * weight[s.kind];
  }
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(columns, columns);  // below its diagonal
  normal.selfadjointView<Eigen::Lower>().rankUpdate(e.slopes.transpose());
  e.scale = normal.diagonal().cwiseSqrt().unaryExpr([](double d) { return d > 0 ? 1 / d : 1; });
  e.normal = e.scale.asDiagonal() * normal * e.scale.asDiagonal();
  e.normal.diagonal().array() += 1e-12;
  e.right = e.scale.asDiagonal() * (e.slopes.transpose() * e.values);
  return e;
}

double PathFits::sd(Kind kind) const { return scale_[kind] * std::sqrt(alike_[kind]); }

double PathFits::score(double squares, std::size_t factors, int more) const {
  double independent = 0;
  for (const Kind kind : {kPlace, kStep}) independent += count_[kind] / alike_[kind];
  const auto unknowns = static_cast<double>(factors) + more;
  return squares + unknowns * std::log(std::max(independent, 2.0));
}

}  // namespace impactdic::impact
