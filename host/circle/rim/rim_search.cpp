// The first rim: strong edges along a few rays over the whole range in which the rim may lie, and
// the circle or ellipse that most rays agree on. Linear in its unknowns about the predicted centre,
//   r(φ) = R + x cos φ + y sin φ + e1 cos 2φ + e2 sin 2φ,
// so that thousands of hypotheses cost little: MSAC (Torr and Zisserman, 2000) with a local
// optimisation under a shrinking tolerance (Chum, Matas and Kittler, 2003).
#include <impactdic/units.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "host/base/statistics.h"
#include "host/circle/rays/rim_rays.h"
#include "host/circle/rim/rim.h"
#include "host/circle/settings/search.h"

namespace impactdic::circle {
namespace {

constexpr const RimSearchSettings& kSearch = kRimSearch;

using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

// Does the ball look brighter than its surroundings? Inner against outer half of most rays.
Polarity likely_polarity(const Profiles& p) {
  int votes = 0;
  for (std::size_t i = 0; i < p.rays.size(); ++i) {
    const float* s = p.samples.data() + i * p.length;
    const int half = p.valid[i] / 2;
    float in = 0, out = 0;
    for (int k = 0; k < half; ++k) {
      in += s[k];
      out += s[p.valid[i] - 1 - k];
    }
    votes += in > out ? 1 : -1;
  }
  return votes >= 0 ? Polarity::kBright : Polarity::kDark;
}

// Finds the strong edges of each ray that fall (ball bright) or rise (dark) outwards.
// Returns how strong a fifth of them are at least.
float find_edges(Profiles& p, const Rim& rim, Polarity polarity) {
  const float sign = sign_of(polarity);
  p.scratch.clear();
  for (std::size_t i = 0; i < p.rays.size(); ++i) {
    const float* s = p.samples.data() + i * p.length;
    float strongest = 0;
    for (int k = 1; k + 1 < p.valid[i]; ++k) {
      strongest = std::max(strongest, sign * (s[k - 1] - s[k + 1]));
    }
    p.scratch.push_back(strongest);
  }
  if (p.scratch.empty()) return 0;
  const float strong = quantile(p.scratch, kSearch.strong_rank);
  const float threshold =
      std::max(static_cast<float>(kSearch.strong) * strong, kSearch.least_strength);
  for (std::size_t i = 0; i < p.rays.size(); ++i) {
    Ray& ray = p.rays[i];
    ray.edges = 0;
    const float* s = p.samples.data() + i * p.length;
    const auto slope = [&](int k) { return sign * (s[k - 1] - s[k + 1]); };
    const double rim_at = rim.radius_at(ray.cos2, ray.sin2) + p.first;
    for (int k = p.valid[i] - 3; k >= 2 && ray.edges < kEdgesPerRay; --k) {
      const float here = slope(k), inner = slope(k - 1), outer = slope(k + 1);
      if (here < threshold || here < inner || here <= outer) continue;
      const float bend = inner - 2 * here + outer;
      const float peak = bend < 0 ? 0.5f * (inner - outer) / bend : 0.0f;
      ray.rho[ray.edges++] = rim_at + k + peak;
    }
  }
  return strong;
}

// What the prior says of (x, y, R, e1, e2), as 1/sd² in units of a coarse edge's scatter.
struct Regular {
  Vector5 mean, weight;
};

// What is searched for, the same for both polarities.
struct SearchTask {
  Rim start;       // as predicted
  double wide_px;  // how far from there the rim may lie
  Shapes shapes;
  Regular prior;
};

Vector5 optimise(const Profiles& p, Vector5 model, double tolerance, const Regular& prior) {
  for (;;) {
    Matrix5 a = prior.weight.asDiagonal();
    Vector5 b = prior.weight.cwiseProduct(prior.mean);
    for (const Ray& ray : p.rays) {
      const double u = ray.residual(model, tolerance) / tolerance;
      if (std::abs(u) >= 1) continue;
      const double w = (1 - u * u) * (1 - u * u);
      const Vector5 j{ray.cos, ray.sin, 1, ray.cos2, ray.sin2};
      a.noalias() += w * j * j.transpose();
      b.noalias() += w * (ray.model(model) + u * tolerance) * j;
    }
    model = a.ldlt().solve(b);
    if (tolerance <= kSearch.inlier_px) return model;
    tolerance = std::max(kSearch.inlier_px, kSearch.tighten * tolerance);
  }
}

// Truncated squares (MSAC); lower is better. At most the number of rays.
double cost(const Profiles& p, const Vector5& model, double tolerance) {
  double sum = 0;
  for (const Ray& ray : p.rays) {
    const double u = ray.residual(model, tolerance) / tolerance;
    sum += u * u;
  }
  return sum;
}

double support(const Profiles& p, const Vector5& model) {
  int agree = 0;
  for (const Ray& ray : p.rays) {
    agree += std::abs(ray.residual(model, kSearch.near_px)) < kSearch.inlier_px;
  }
  return p.in_view > 0 ? std::min(1.0, static_cast<double>(agree) / p.in_view) : 0;
}

// A small generator of its own so that a frame gives the same answer on every machine and thread.
struct Lottery {
  std::uint64_t state = 0x9E3779B97F4A7C15u;
  int below(int n) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<int>((state >> 33) % static_cast<std::uint64_t>(n));
  }
};

// A circle of the prior's shape through three edges, or an ellipse through five. False where the
// rays drawn have none, or the prior does not allow it.
bool hypothesis(const Profiles& p, const Regular& prior, int edges, Lottery& lottery,
                Vector5& model) {
  Matrix5 a = Matrix5::Zero();
  Vector5 b = Vector5::Zero();
  const int n = static_cast<int>(p.rays.size());
  const int start = lottery.below(n);
  for (int k = 0; k < edges; ++k) {
    // One from each of as many sectors: hypotheses through neighbours say nothing.
    const int sector = n / edges;
    const Ray& ray = p.rays[(start + k * sector + lottery.below(sector)) % n];
    if (ray.edges == 0) return false;
    const Vector5 j{ray.cos, ray.sin, 1, ray.cos2, ray.sin2};
    a.noalias() += j * j.transpose();
    b.noalias() += ray.rho[lottery.below(ray.edges)] * j;
  }
  for (int i = 0; i < 5; ++i) {
    const bool fixed = i >= 3 && edges == 3;
    const double w = fixed ? kSearch.seed_shape : kSearch.seed_prior * prior.weight[i];
    a(i, i) += w;
    b[i] += w * prior.mean[i];
  }
  model = a.ldlt().solve(b);
  for (int i = 0; i < 5; ++i) {
    const double deviations =
        (model[i] - prior.mean[i]) * std::sqrt(prior.weight[i]) / kSearch.edge_sd_px;
    if (!(std::abs(deviations) < kSearch.seed_sds)) return false;
  }
  return true;
}

Vector5 consensus(const Profiles& p, const SearchTask& task) {
  const Regular& prior = task.prior;
  Vector5 best = optimise(p, prior.mean, task.wide_px, prior);
  if (support(p, best) > kSearch.trusted || p.rays.size() < kSearch.least_drawn_from) return best;
  const double seed_px = kSearch.seed_wide * task.wide_px + kSearch.inlier_px;
  const double refine_px = kSearch.seed_refine * task.wide_px + kSearch.inlier_px;
  double lowest = cost(p, best, kSearch.inlier_px), lowest_seed = cost(p, best, seed_px);
  Lottery lottery;
  for (int trial = 0; trial < kSearch.hypotheses; ++trial) {
    Vector5 seed;
    const bool oval = task.shapes == Shapes::kCircleOrEllipse && trial % 2 == 1;
    if (!hypothesis(p, prior, oval ? 5 : 3, lottery, seed)) continue;
    const double seed_cost = cost(p, seed, seed_px);
    if (seed_cost > kSearch.seed_slack * lowest_seed) continue;
    lowest_seed = std::min(lowest_seed, seed_cost);
    const Vector5 model = optimise(p, seed, refine_px, prior);
    const double model_cost = cost(p, model, kSearch.inlier_px);
    if (model_cost < lowest) {
      lowest = model_cost;
      best = model;
    }
  }
  return best;
}

// The edge's width: contrast over steepest slope. The median over the rays that agree.
double edge_blur(Profiles& p, const Rim& rim, const Vector5& model, Polarity polarity) {
  constexpr int kHalf = kSearch.blur_half_px, kNear = kSearch.blur_near_px;
  p.scratch.clear();
  const float sign = sign_of(polarity);
  for (std::size_t i = 0; i < p.rays.size(); ++i) {
    const Ray& ray = p.rays[i];
    if (std::abs(ray.residual(model, kSearch.near_px)) > kSearch.inlier_px) continue;
    const float* s = p.samples.data() + i * p.length;
    const double at = ray.model(model) - rim.radius_at(ray.cos2, ray.sin2) - p.first;
    const int k = static_cast<int>(std::lround(at));
    if (k < kHalf || k + kHalf >= p.valid[i]) continue;
    float steepest = 0;
    for (int m = k - kNear; m < k + kNear; ++m) {
      steepest = std::max(steepest, sign * (s[m] - s[m + 1]));
    }
    const float contrast = sign * (s[k - kHalf] - s[k + kHalf]);
    if (steepest > 0 && contrast > 0) p.scratch.push_back(contrast / steepest);
  }
  if (p.scratch.size() < kSearch.blur_least_rays) return 1;
  return upper_median(p.scratch) / std::sqrt(2 * kPi);
}

enum class Edges { kStrong, kClearDepartures, kPooledDepartures };

RimSearch search_one(Profiles& p, const SearchTask& task, Polarity polarity,
                     Edges edges = Edges::kStrong) {
  const Rim& start = task.start;
  RimSearch result;
  result.polarity = polarity;
  result.in_view = static_cast<double>(p.in_view) / p.cast;
  if (edges == Edges::kStrong) {
    result.strength = find_edges(p, start, polarity);
  } else if (edges == Edges::kClearDepartures || !find_pooled_departures(p, start)) {
    find_departures(p, start);
  }
  if (p.rays.size() < static_cast<std::size_t>(kSearch.least_rays)) return result;
  const Vector5 model = consensus(p, task);
  result.support = support(p, model);
  // The linear model's second order: a circle d away from the rays' centre is d²/4R larger.
  const double d_sq = model[0] * model[0] + model[1] * model[1];
  result.rim = {start.cx + model[0], start.cy + model[1], model[2] + d_sq / (4 * start.r), model[3],
                model[4]};
  result.found = result.rim.r > kSearch.least_r_px && result.support > kSearch.least_support &&
                 std::hypot(model[3], model[4]) < kSearch.most_oval * result.rim.r;
  if (result.found && edges == Edges::kStrong)
    result.blur_px = edge_blur(p, start, model, polarity);
  return result;
}

SearchTask task_of(const CirclePrior& prior, const CircleOptions& options) {
  const double radius = prior.predicted.r_px;
  const double rim_sd = prior.rim_sd_px.value_or(kSearch.rim_sd_of_r * radius);
  SearchTask task;
  task.start = rim_of(prior);
  task.wide_px = kSearch.sds * std::hypot(prior.centre_sd_px, rim_sd) + kSearch.inlier_px;
  task.shapes = options.allow_ellipse ? Shapes::kCircleOrEllipse : Shapes::kCircle;
  task.prior.mean << 0, 0, radius, prior.e1_px, prior.e2_px;
  const double centre = kSearch.edge_sd_px / std::max(prior.centre_sd_px, kSearch.least_sd_px);
  const double shape = kSearch.edge_sd_px / std::max(rim_sd, kSearch.least_sd_px);
  const double oval = options.allow_ellipse ? shape : kSearch.fixed_weight;
  task.prior.weight << centre * centre, centre * centre, shape * shape, oval * oval, oval * oval;
  return task;
}

// The rays that `task` wants, in this thread's memory.
Profiles& profiles_of(const Frame& frame, const SearchTask& task, const CircleOptions& options) {
  // Far enough for levels on both sides of the edge.
  const double outward = task.wide_px + kSearch.beside_px;
  const double inward = std::min(outward, task.start.r - 1);
  const int count = std::max(kSearch.rays, options.rays / kSearch.of_usual_rays);

  thread_local Profiles profiles;  // memory only
  if (frame.type == PixelType::kU8) {
    sample_rays(frame.u8.view(), task.start, inward, outward, count, profiles);
  } else {
    sample_rays(frame.u16.view(), task.start, inward, outward, count, profiles);
  }

  return profiles;
}

}  // namespace

RimSearch search_outline(const Frame& frame, const CirclePrior& prior, const CircleOptions& options,
                         Departures departures) {
  const SearchTask task = task_of(prior, options);
  Profiles& profiles = profiles_of(frame, task, options);
  const Polarity likely = prior.bright ? polarity_of(*prior.bright) : likely_polarity(profiles);
  return search_one(
      profiles, task, likely,
      departures == Departures::kClear ? Edges::kClearDepartures : Edges::kPooledDepartures);
}

RimSearch search_rim(const Frame& frame, const CirclePrior& prior, const CircleOptions& options) {
  const SearchTask task = task_of(prior, options);
  Profiles& profiles = profiles_of(frame, task, options);
  const Polarity likely = prior.bright ? polarity_of(*prior.bright) : likely_polarity(profiles);
  RimSearch first = search_one(profiles, task, likely);
  if (prior.bright || first.support > kSearch.plain) return first;
  RimSearch second = search_one(profiles, task, opposite(likely));
  // A lamp leaves one side of a ball darker than the background: both edges lie on the same rim,
  // and the stronger one tells more.
  const bool same = first.found && second.found &&
                    std::hypot(first.rim.cx - second.rim.cx, first.rim.cy - second.rim.cy) +
                            std::abs(first.rim.r - second.rim.r) <
                        kSearch.same_rim_of_r * task.start.r;
  if (!same && first.support > kSearch.trusted) return first;
  const double a = first.support * (same ? first.strength : 1);
  const double b = second.support * (same ? second.strength : 1);
  return b > a ? second : first;
}

}  // namespace impactdic::circle
