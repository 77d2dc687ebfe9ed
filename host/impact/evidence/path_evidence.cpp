#include "host/impact/evidence/path_evidence.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "host/base/parallel/parallel_for.h"
#include "host/base/statistics.h"
#include "host/impact/evidence/contact_guess.h"

namespace impactdic::impact {
namespace {

using Basis = std::vector<std::function<double(double)>>;  // of the place, at an instant

enum Kind { kPlace, kStep, kKinds };

struct Sample {
  double at, value;  // a step leads to at + 1
  Kind kind;
};

// Frames before and behind a contact that are looked at: enough for any path to show its bends, and
// a long clip takes no longer.
constexpr std::size_t kMostFrames = 500;
constexpr double kOff = 8;  // deviations of the noise beyond which a single frame is bad
constexpr double kInfinite = std::numeric_limits<double>::infinity();

PathSpan near_contact(PathSpan span) {
  span.begin = std::max(span.begin, span.first - std::min(span.first, kMostFrames));
  span.end = std::min(span.end, span.last + kMostFrames);
  return span;
}

// What was measured, less single frames that lie far from those about them.
void add_samples(const std::vector<double>& all, const PathSpan& span, Kind kind,
                 std::vector<Sample>& samples) {
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
    samples.push_back({static_cast<double>(span.begin + i), values[i], kind});
  }
}

struct PathFit {
  double score = kInfinite;  // the criterion, twice a negative logarithm
  Eigen::VectorXd residuals;
};

class PathFits {
 public:
  PathFits(const ImpactSeries& series, const PathSpan& span) {
    add_samples(series.position_n, span, kPlace, samples_);
    if (!series.from_circle) add_samples(series.step_n, span, kStep, samples_);
    for (const Sample& s : samples_) ++count_[s.kind];
    scale_[kPlace] = noise_of(series.position_n);
    scale_[kStep] = noise_of(series.step_n);
    for (double& scale : scale_) scale = scale > 1e-7 ? scale : 1e-7;
    for (std::size_t i = span.begin; i <= span.end; ++i) {
      instants_.push_back(static_cast<double>(i));
    }
  }

  std::size_t size() const { return samples_.size(); }

  // `more`: unknowns beside the factors of `basis`.
  PathFit fit(const Basis& basis, int more = 0) const {
    const auto rows = static_cast<Eigen::Index>(samples_.size());
    const auto columns = static_cast<Eigen::Index>(basis.size());
    Eigen::MatrixXd slopes(rows, columns);
    Eigen::VectorXd values(rows);
    const std::array<double, kKinds> weight = {1 / scale_[kPlace], 1 / scale_[kStep]};
    std::vector<double> places(instants_.size());  // places and steps share their instants
    for (Eigen::Index k = 0; k < columns; ++k) {
      std::transform(instants_.begin(), instants_.end(), places.begin(),
                     basis[static_cast<std::size_t>(k)]);
      for (Eigen::Index i = 0; i < rows; ++i) {
        const Sample& s = samples_[static_cast<std::size_t>(i)];
        const auto at = static_cast<std::size_t>(s.at - instants_.front());
        const double place = s.kind == kPlace ? places[at] : places[at + 1] - places[at];
        slopes(i, k) = weight[s.kind] * place;
      }
    }
    for (Eigen::Index i = 0; i < rows; ++i) {
      const Sample& s = samples_[static_cast<std::size_t>(i)];
      values[i] = s.value * weight[s.kind];
    }
    Eigen::MatrixXd normal = slopes.transpose() * slopes;
    const Eigen::VectorXd scale =
        normal.diagonal().cwiseSqrt().unaryExpr([](double d) { return d > 0 ? 1 / d : 1; });
    normal = scale.asDiagonal() * normal * scale.asDiagonal();
    normal.diagonal().array() += 1e-12;
    const Eigen::VectorXd right = scale.asDiagonal() * (slopes.transpose() * values);
    const Eigen::VectorXd solution = scale.asDiagonal() * normal.ldlt().solve(right);
    PathFit fit;
    fit.residuals = values - slopes * solution;
    fit.score = score(fit.residuals, static_cast<double>(columns + more));
    return fit;
  }

  // Weights of places and steps by what `fit` leaves of each outside of the contact, and how many
  // frames of each count as one because they err alike.
  void take_scatter(const PathFit& fit, const PathSpan& span) {
    for (const Kind kind : {kPlace, kStep}) {
      std::vector<double> left;
      for (std::size_t i = 0; i < samples_.size(); ++i) {
        const Sample& s = samples_[i];
        const bool in =
            s.at > static_cast<double>(span.first) - 2 && s.at < static_cast<double>(span.last) + 2;
        if (s.kind == kind && !in) left.push_back(fit.residuals[static_cast<int>(i)]);
      }
      if (left.size() < 6) continue;
      double squares = 0;
      for (const double r : left) squares += r * r;
      scale_[kind] *= std::max(std::sqrt(squares / static_cast<double>(left.size())), 1e-6);
      alike_[kind] = alike(left, squares);
    }
  }

 private:
  // The sum of the residuals' correlations (Sokal 1997), at least 1.
  static double alike(const std::vector<double>& left, double squares) {
    const double chance = 2 / std::sqrt(static_cast<double>(left.size()));
    double sum = 1;
    for (std::size_t lag = 1; lag < left.size() / 2; ++lag) {
      double products = 0;
      for (std::size_t i = 0; i + lag < left.size(); ++i) products += left[i] * left[i + lag];
      if (!(products > chance * squares)) break;
      sum += 2 * products / squares;
    }
    return sum;
  }

  double score(const Eigen::VectorXd& residuals, double unknowns) const {
    std::array<double, kKinds> squares{};
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      squares[samples_[i].kind] += std::pow(residuals[static_cast<int>(i)], 2);
    }
    double sum = 0, independent = 0;
    for (const Kind kind : {kPlace, kStep}) {
      if (count_[kind] == 0) continue;
      const double count = count_[kind] / alike_[kind];
      sum += squares[kind] / alike_[kind];
      independent += count;
    }
    return sum + unknowns * std::log(std::max(independent, 2.0));
  }

  std::vector<Sample> samples_;
  std::vector<double> instants_;  // of all samples, ascending
  std::array<double, kKinds> count_{}, scale_{}, alike_ = {1, 1};
};

// Legendre's polynomials, from -1 to 1 within the span.
double legendre(int degree, double x) {
  double last = 1, value = x;
  if (degree == 0) return 1;
  for (int n = 1; n < degree; ++n) {
    const double next = ((2 * n + 1) * x * value - n * last) / (n + 1);
    last = value, value = next;
  }
  return value;
}

double cubic_b_spline(double x) {
  x = std::abs(x);
  if (x >= 2) return 0;
  return x >= 1 ? (2 - x) * (2 - x) * (2 - x) / 6 : 2.0 / 3 - x * x + x * x * x / 2;
}

double positive_square(double x) { return x > 0 ? x * x : 0; }
double positive_cube(double x) { return x > 0 ? x * x * x : 0; }

class Paths {
 public:
  explicit Paths(const PathSpan& span)
      : span_(span),
        middle_(static_cast<double>(span.begin + span.end) / 2),
        half_(std::max(1.0, static_cast<double>(span.end - span.begin) / 2)) {}

  double frames() const { return 2 * half_; }

  Basis polynomial(int degree) const {
    Basis basis;
    for (int n = 0; n <= degree; ++n) {
      basis.emplace_back([this, n](double t) { return legendre(n, unit(t)); });
    }
    return basis;
  }

  Basis spline(int pieces) const {
    Basis basis;
    for (int n = -1; n <= pieces + 1; ++n) {
      basis.emplace_back(
          [this, n, pieces](double t) { return cubic_b_spline((unit(t) + 1) / 2 * pieces - n); });
    }
    return basis;
  }

  // `rate` in radians a frame.
  Basis circle(double rate, int harmonics) const {
    Basis basis = polynomial(1);
    for (int n = 1; n <= harmonics; ++n) {
      basis.emplace_back([this, n, rate](double t) { return std::cos(n * rate * (t - middle_)); });
      basis.emplace_back([this, n, rate](double t) { return std::sin(n * rate * (t - middle_)); });
    }
    return basis;
  }

  Basis released(double at) const {
    Basis basis = polynomial(2);
    basis.emplace_back([at](double t) { return positive_square(t - at); });
    return basis;
  }

  // The contact's acceleration in so many pieces, from `more` frames before its guessed beginning
  // to as many after its end: constant in each, or else linear and continuous.
  Basis broken(int pieces, double more, bool constant) const {
    Basis basis = polynomial(2);
    const double first = static_cast<double>(span_.first) - more;
    const double width = (static_cast<double>(span_.last) + more - first) / pieces;
    for (int n = 0; n < pieces - (constant ? 0 : 1); ++n) {
      const double from = first + n * width;
      basis.emplace_back([=](double t) {
        const double x = (t - from) / width;
        if (constant) return positive_square(x) - positive_square(x - 1);
        return positive_cube(x) - 2 * positive_cube(x - 1) + positive_cube(x - 2);
      });
    }
    return basis;
  }

  // A force that rises and falls as a half sine, leaning to one side, with a step at its ends.
  Basis pulse(double first, double last) const {
    Basis basis = polynomial(2);
    const double width = last - first;
    for (const int waves : {0, 1, 2}) {
      basis.emplace_back([=](double t) {
        const double x = std::clamp((t - first) / width, 0.0, 1.0), after = t - last;
        const double on = std::max(after, 0.0) / width, w = waves * kPi;
        if (waves == 0) return x * x / 2 + on;
        const double speed = (1 - std::cos(w)) / w;  // at the end
        return x / w - std::sin(w * x) / (w * w) + on * speed;
      });
    }
    return basis;
  }

 private:
  double unit(double t) const { return (t - middle_) / half_; }

  PathSpan span_;
  double middle_, half_;
};

// Of paths with an acceleration in the contact, the one that describes the samples best.
PathFit best_broken(const Paths& paths, const PathFits& fits, const PathSpan& span) {
  std::vector<std::pair<Basis, int>> tried;  // with its unknowns beside the factors
  const double length = static_cast<double>(span.last - span.first);
  for (const double more : {std::max(0.5, length / 20), std::max(1.5, length / 5)}) {
    for (int pieces = 1; pieces <= 32 && (pieces == 1 || pieces <= length + 2 * more);
         pieces *= 2) {
      for (const bool constant : {true, false}) {
        if (!constant && pieces == 1) continue;
        tried.emplace_back(paths.broken(pieces, more, constant), 0);
      }
    }
  }
  for (const double first : {-0.1, 0.0, 0.1, 0.2}) {
    for (const double last : {-0.2, -0.1, 0.0, 0.1}) {
      tried.emplace_back(paths.pulse(static_cast<double>(span.first) + first * length,
                                     static_cast<double>(span.last) + last * length + 1e-3),
                         2);
    }
  }
  std::vector<PathFit> found(tried.size());
  parallel_for(tried.size(), 0,
               [&](std::size_t i) { found[i] = fits.fit(tried[i].first, tried[i].second); });
  return *std::min_element(found.begin(), found.end(),
                           [](const PathFit& a, const PathFit& b) { return a.score < b.score; });
}

// The least value of `score` near its least on a grid, by golden section (Kiefer 1953).
template <typename Score>
double least(const std::vector<double>& grid, const Score& score) {
  constexpr double kGolden = 0.6180339887498949;
  constexpr int kRounds = 24;
  std::vector<double> found(grid.size());
  parallel_for(grid.size(), 0, [&](std::size_t i) { found[i] = score(grid[i]); });
  const auto at =
      static_cast<std::size_t>(std::min_element(found.begin(), found.end()) - found.begin());
  double low = grid[at - std::min<std::size_t>(at, 1)];
  double high = grid[std::min(at + 1, grid.size() - 1)];
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  double at_a = score(a), at_b = score(b);
  for (int round = 0; round < kRounds; ++round) {
    if (at_a < at_b) {
      high = b, b = a, at_b = at_a, a = high - kGolden * (high - low), at_a = score(a);
    } else {
      low = a, a = b, at_a = at_b, b = low + kGolden * (high - low), at_b = score(b);
    }
  }
  return std::min({found[at], at_a, at_b});
}

// From a sixth of a turn in the span to four turns.
double best_circle(const Paths& paths, const PathFits& fits, int harmonics) {
  std::vector<double> grid;  // logarithms of the rate
  for (double turns = 1.0 / 6; turns < 4; turns *= 1.25) {
    grid.push_back(std::log(2 * kPi * turns / paths.frames()));
  }
  return least(grid, [&](double rate) {
    return fits.fit(paths.circle(std::exp(rate), harmonics), 1).score;
  });
}

// Held or rolling, and then let go, or the reverse: another acceleration from some instant on.
double best_release(const Paths& paths, const PathFits& fits, const PathSpan& span) {
  constexpr int kPlaces = 24;
  std::vector<double> grid;
  for (int n = 0; n <= kPlaces; ++n) {
    grid.push_back(static_cast<double>(span.begin) + n * paths.frames() / kPlaces);
  }
  return least(grid, [&](double at) { return fits.fit(paths.released(at), 1).score; });
}

// The least score of all paths without a contact.
double best_smooth(const Paths& paths, const PathFits& fits, const PathSpan& span) {
  constexpr int kHighestDegree = 9, kMostPieces = 16, kMostHarmonics = 4;
  std::vector<std::function<double()>> families;
  for (int harmonics = kMostHarmonics; harmonics >= 1; --harmonics) {  // those that last first
    families.emplace_back([&, harmonics] { return best_circle(paths, fits, harmonics); });
  }
  families.emplace_back([&] { return best_release(paths, fits, span); });
  for (int pieces = 4; pieces <= kMostPieces && 4 * pieces <= paths.frames(); pieces *= 2) {
    families.emplace_back([&, pieces] { return fits.fit(paths.spline(pieces)).score; });
  }
  for (int degree = 2; degree <= kHighestDegree; ++degree) {
    families.emplace_back([&, degree] { return fits.fit(paths.polynomial(degree)).score; });
  }
  std::vector<double> scores(families.size());
  parallel_for(families.size(), 0, [&](std::size_t i) { scores[i] = families[i](); });
  return *std::min_element(scores.begin(), scores.end());
}

}  // namespace

double odds_of_contact(const ImpactSeries& series, const PathSpan& whole) {
  const PathSpan span = near_contact(whole);
  PathFits fits(series, span);
  if (fits.size() < 10) return 0;
  const Paths paths(span);
  for (int round = 0; round < 2; ++round) fits.take_scatter(best_broken(paths, fits, span), span);
  return (best_smooth(paths, fits, span) - best_broken(paths, fits, span).score) / 2;
}

}  // namespace impactdic::impact
