#include "host/camera/calibrate/solve.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/base/statistics.h"

namespace impactdic::camera {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

namespace {

constexpr double kOutlier = 5;            // deviations beyond which a point is a wrong one
constexpr double kLeastSd_px = 1e-6;      // exact points, as tests have them
constexpr double kMadToSd = 1.4826;       // of a normal distribution
constexpr double kFocalKnown = 0.1;       // relative deviation
constexpr std::size_t kFewestOfView = 6;  // of a view that tells more than its own pose
constexpr double kLeastWeight = 1e-4;     // of a model beside the best
constexpr double kDiffers = 4;            // deviations between a view's scatter and the others'

// A view's residuals over the points' deviations.
std::vector<Vector2d> whitened(const Bundle& bundle, const Adjusted& state, const Weights& weights,
                               std::size_t view) {
  std::vector<Vector2d> off = bundle.residuals(state, view);
  for (std::size_t i = 0; i < off.size(); ++i) {
    off[i] = whitening(bundle.views()[view].seen[i], weights.sd_px[view]) * off[i];
  }
  return off;
}

// Scatter of residuals along one axis, over the points' deviations, whatever a few wrong points do.
double robust_sd(const Bundle& bundle, const Adjusted& state, const Weights& weights) {
  std::vector<double> sizes;
  for (std::size_t v = 0; v < bundle.views().size(); ++v) {
    const std::vector<Vector2d> off = whitened(bundle, state, weights, v);
    for (std::size_t i = 0; i < off.size(); ++i) {
      if (!weights.used[v][i]) continue;
      sizes.push_back(std::abs(off[i].x()));
      sizes.push_back(std::abs(off[i].y()));
    }
  }
  if (sizes.empty()) return kLeastSd_px;
  return std::max(kMadToSd * upper_median(std::move(sizes)), kLeastSd_px);
}

// Takes out wrong points, and takes back those that came right. True where something changed.
bool reject(const Bundle& bundle, const Adjusted& state, Weights& weights) {
  const double most = kOutlier * robust_sd(bundle, state, weights);
  bool changed = false;
  for (std::size_t v = 0; v < bundle.views().size(); ++v) {
    std::vector<char> used;
    for (const Vector2d& one : whitened(bundle, state, weights, v)) {
      used.push_back(one.norm() <= most);
    }
    if (static_cast<std::size_t>(std::count(used.begin(), used.end(), 1)) < kFewestOfView) continue;
    changed = changed || used != weights.used[v];
    weights.used[v] = std::move(used);
  }
  return changed;
}

// Residuals of points that take part, each with the point's own covariance.
struct Residuals {
  std::vector<std::pair<Sighting, Vector2d>> points;
  double freedom = 0;  // numbers less those that the fit took

  double chi_square(double sd_px) const {
    double sum = 0;
    for (const auto& [sighting, off] : points)
      sum += (whitening(sighting, sd_px) * off).squaredNorm();
    return sum;
  }
  // What the points scatter by beyond their own covariances, so that the residuals are as large as
  // chance makes them.
  double scatter_px() const {
    double squares = 0;
    for (const auto& [sighting, off] : points) squares += off.squaredNorm();
    double low = kLeastSd_px, high = std::max(std::sqrt(squares / freedom), kLeastSd_px);
    if (chi_square(low) <= freedom) return low;
    while (high > low * (1 + 1e-9)) {
      const double middle = std::sqrt(low * high);
      (chi_square(middle) > freedom ? low : high) = middle;
    }
    return high;
  }
};

// The points' own deviation: from the residuals, less the freedom that the fit took. A view that
// is plainly better or worse than the others has one of its own. Returns the root of the mean
// square residual.
double set_deviations(const Bundle& bundle, const Adjusted& state, Weights& weights) {
  const double views = static_cast<double>(bundle.views().size());
  const double lens_share = state.terms.count() / views;
  std::vector<Residuals> of_view;
  Residuals all;
  double squares = 0;
  for (std::size_t v = 0; v < bundle.views().size(); ++v) {
    const std::vector<Vector2d> off = bundle.residuals(state, v);
    Residuals one;
    for (std::size_t i = 0; i < off.size(); ++i) {
      if (!weights.used[v][i]) continue;
      one.points.emplace_back(bundle.views()[v].seen[i], off[i]);
      squares += off[i].squaredNorm();
    }
    one.freedom = 2.0 * static_cast<double>(one.points.size()) - kPoseValues - lens_share;
    all.points.insert(all.points.end(), one.points.begin(), one.points.end());
    all.freedom += one.freedom;
    of_view.push_back(std::move(one));
  }
  if (!(all.freedom >= 1)) {
    throw InvalidArgument("too few points for a camera", bundle.views().front().picture,
                          "more pictures of the target, tilted to all sides");
  }
  const double common = all.scatter_px();
  for (std::size_t v = 0; v < of_view.size(); ++v) {
    const Residuals& one = of_view[v];
    weights.sd_px[v] = common;
    if (!(one.freedom > 4)) continue;
    const double ratio = one.chi_square(common) / one.freedom;
    if (std::abs(std::log(std::max(ratio, 1e-12))) > kDiffers * std::sqrt(2 / one.freedom)) {
      weights.sd_px[v] = one.scatter_px();
    }
  }
  return std::max(std::sqrt(squares / all.freedom), kLeastSd_px);
}

// Schwarz 1978: -2 times the logarithm of how probable the points make a model, but for a constant.
double schwarz(const Adjusted& state, const Weights& weights) {
  const double n = 2.0 * static_cast<double>(weights.points());
  const double k = state.terms.count() + kPoseValues * static_cast<double>(state.poses.size()) + 1;
  if (!(n > k + 1)) return std::numeric_limits<double>::infinity();
  return n * std::log(state.chi_square / n) + k * std::log(n);
}

std::vector<LensTerms> ladder() {
  std::vector<LensTerms> models;
  for (const bool aspect : {false, true}) {
    for (int radial = 0; radial <= 3; ++radial) {
      models.push_back({radial, false, aspect});
      if (radial > 0) models.push_back({radial, true, aspect});
    }
  }
  return models;
}

VectorXd joined(const Adjusted& state, std::size_t plane) {
  VectorXd all(kLensValues + kPoseValues);
  all << state.lens, state.poses[plane];
  return all;
}

// A start that no wrong point and no wrong turn of the target spoils.
Adjusted settle(const Bundle& bundle, Weights& weights) {
  const LensTerms simple{1, false, false};
  Adjusted state = bundle.adjust(simple, bundle.guess(weights), weights);
  for (int round = 0; round < 8; ++round) {
    const bool turned = bundle.turn_over(state, weights);
    const bool changed = reject(bundle, state, weights);
    if (!turned && !changed && round > 0) break;
    state = bundle.adjust(simple, std::move(state), weights);
  }
  const LensTerms full{2, true, false};
  for (int round = 0; round < 4; ++round) {
    state = bundle.adjust(full, std::move(state), weights);
    if (!reject(bundle, state, weights)) break;
  }
  return state;
}

// A model's weight, its lens and the plane's pose, and their covariance.
struct Candidate {
  double weight;
  VectorXd values;
  MatrixXd covariance;
};

// The mean of the models by their weights, and its covariance with what they differ by (Hoeting,
// Madigan, Raftery and Volinsky 1999, section 2).
std::pair<VectorXd, MatrixXd> averaged(const std::vector<Candidate>& candidates) {
  const Eigen::Index size = candidates.front().values.size();
  VectorXd mean = VectorXd::Zero(size);
  MatrixXd covariance = MatrixXd::Zero(size, size);
  double sum = 0;
  for (const Candidate& one : candidates) sum += one.weight;
  for (const Candidate& one : candidates) mean += one.weight / sum * one.values;
  for (const Candidate& one : candidates) {
    const VectorXd off = one.values - mean;
    covariance += one.weight / sum * (one.covariance + off * off.transpose());
  }
  return {mean, covariance};
}

}  // namespace

Solved solve(const Bundle& bundle, int width, int height, std::size_t plane, double pitch_sd,
             const char* from) {
  Solved solved;
  solved.weights = bundle.first_weights();
  Adjusted start = settle(bundle, solved.weights);
  for (int round = 0; round < 4; ++round) {
    set_deviations(bundle, start, solved.weights);
    start = bundle.adjust(start.terms, start, solved.weights);
    if (!reject(bundle, start, solved.weights)) break;
  }
  std::vector<Adjusted> models;
  std::vector<double> evidence;
  std::size_t best = 0;
  for (const LensTerms& terms : ladder()) {
    models.push_back(bundle.adjust(terms, start, solved.weights));
    evidence.push_back(schwarz(models.back(), solved.weights));
    if (evidence.back() < evidence[best]) best = models.size() - 1;
  }
  if (!std::isfinite(evidence[best])) {
    throw InvalidArgument("too few points for a camera", bundle.views().front().picture,
                          "more pictures of the target, tilted to all sides");
  }
  solved.sd_px = set_deviations(bundle, models[best], solved.weights);
  solved.state = bundle.adjust(models[best].terms, models[best], solved.weights);
  std::vector<Candidate> candidates;
  for (std::size_t m = 0; m < models.size(); ++m) {
    const double weight = std::exp(-0.5 * (evidence[m] - evidence[best]));
    if (!(weight > kLeastWeight)) continue;
    const Adjusted model =
        m == best ? solved.state : bundle.adjust(models[m].terms, models[m], solved.weights);
    candidates.push_back(
        {weight, joined(model, plane), bundle.covariance(model, solved.weights, plane)});
  }
  auto [found, covariance] = averaged(candidates);
  covariance.bottomRightCorner<3, 3>() +=
      pitch_sd * pitch_sd * found.tail<3>() * found.tail<3>().transpose();
  solved.camera.width = width;
  solved.camera.height = height;
  solved.camera.from = from;
  Eigen::Map<VectorXd>(solved.camera.values.data(), found.size()) = found;
  Eigen::Map<MatrixXd>(solved.camera.covariance.data(), found.size(), found.size()) = covariance;
  const double focal_sd = std::sqrt(covariance(0, 0)) / found[0];
  solved.camera.focal_length_known = focal_sd < kFocalKnown;
  return solved;
}

}  // namespace impactdic::camera
