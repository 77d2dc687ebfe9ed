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

#include "host/circle/rim/rim.h"

namespace impactdic::circle {
namespace {

constexpr int kEdgesPerRay = 3;  // the outermost strong edges of each ray
constexpr double kStrong = 0.3;  // of the strength that a fifth of the rays exceed
constexpr double kInlier_px = 1.0;
constexpr double kTrusted = 0.55;  // support at which the prediction needs no hypotheses
constexpr int kHypotheses = 240;
constexpr double kRimSdOfRadius = 0.025;
constexpr double kEdge_px = 0.3;  // scatter of a coarse edge, against the prior's figures

using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

struct Ray {
  double cos, sin, cos2, sin2;
  int edges = 0;
  std::array<double, kEdgesPerRay> rho;  // distance of each edge from the predicted centre

  double model(const Vector5& p) const {
    return p[0] * cos + p[1] * sin + p[2] + p[3] * cos2 + p[4] * sin2;
  }
  // Residual of the edge nearest to the model; `none` where the ray has no edge.
  double residual(const Vector5& p, double none) const {
    const double at = model(p);
    double best = none;
    for (int k = 0; k < edges; ++k) {
      const double r = rho[k] - at;
      if (std::abs(r) < std::abs(best)) best = r;
    }
    return best;
  }
};

struct Profiles {
  std::vector<Ray> rays;
  std::vector<float> samples;  // (rays, length), from the inner to the outer end, 1 px apart
  std::vector<int> valid;      // samples of each ray that lie in the picture
  std::vector<float> scratch;
  int length = 0;
  double first = 0;  // distance of sample 0 from the predicted rim
  int in_view = 0;   // rays whose predicted rim lies in the picture
  int cast = 0;
  double blur_px = 1;
};

template <typename T>
void sample_rays(ImageView<const T> picture, const Rim& rim, double inward, double outward,
                 int count, Profiles& p) {
  const Sampler<T> sampler(picture);
  p.first = -std::floor(inward);
  p.length = static_cast<int>(std::floor(inward) + std::floor(outward)) + 1;
  p.rays.clear();
  p.valid.clear();
  p.samples.resize(static_cast<std::size_t>(count) * p.length);
  p.in_view = 0;
  p.cast = count;
  const double step = 2 * kPi / count;
  for (int i = 0; i < count; ++i) {
    Ray ray;
    ray.cos = std::cos(i * step);
    ray.sin = std::sin(i * step);
    ray.cos2 = ray.cos * ray.cos - ray.sin * ray.sin;
    ray.sin2 = 2 * ray.cos * ray.sin;
    const double rim_at = rim.radius_at(ray.cos2, ray.sin2);
    const float dx = static_cast<float>(ray.cos), dy = static_cast<float>(ray.sin);
    const float x0 = static_cast<float>(rim.cx + (rim_at + p.first) * ray.cos);
    const float y0 = static_cast<float>(rim.cy + (rim_at + p.first) * ray.sin);
    const float x_rim = static_cast<float>(rim.cx + rim_at * ray.cos);
    const float y_rim = static_cast<float>(rim.cy + rim_at * ray.sin);
    if (sampler.inside(x_rim, y_rim, 3)) ++p.in_view;
    if (!sampler.inside(x0, y0, 1.5f)) continue;
    const float reach = sampler.reach(x0, y0, dx, dy, 1.5f);
    const int valid = std::min(p.length, static_cast<int>(std::min(reach, 1e6f)) + 1);
    if (valid < 5) continue;
    float* out = p.samples.data() + p.rays.size() * p.length;
    for (int k = 0; k < valid; ++k) {
      const float t = static_cast<float>(k);
      out[k] = sampler.bilinear(x0 + t * dx, y0 + t * dy);
    }
    p.rays.push_back(ray);
    p.valid.push_back(valid);
  }
}

// Does the ball look brighter than its surroundings? Inner against outer half of most rays.
bool looks_bright(Profiles& p) {
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
  return votes >= 0;
}

// Finds the strong edges of each ray that fall (ball bright) or rise (dark) outwards.
void find_edges(Profiles& p, const Rim& rim, bool bright) {
  const float sign = bright ? 1.0f : -1.0f;
  p.scratch.clear();
  for (std::size_t i = 0; i < p.rays.size(); ++i) {
    const float* s = p.samples.data() + i * p.length;
    float strongest = 0;
    for (int k = 1; k + 1 < p.valid[i]; ++k) {
      strongest = std::max(strongest, sign * (s[k - 1] - s[k + 1]));
    }
    p.scratch.push_back(strongest);
  }
  if (p.scratch.empty()) return;
  const auto rank = p.scratch.begin() + static_cast<std::ptrdiff_t>(0.8 * p.scratch.size());
  std::nth_element(p.scratch.begin(), rank, p.scratch.end());
  const float threshold = std::max(static_cast<float>(kStrong) * *rank, 1e-3f);
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
}

// What the prior says of (x, y, R, e1, e2), as 1/sd² in units of a coarse edge's scatter.
struct Regular {
  Vector5 mean, weight;
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
    if (tolerance <= kInlier_px) return model;
    tolerance = std::max(kInlier_px, 0.6 * tolerance);
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
  for (const Ray& ray : p.rays) agree += std::abs(ray.residual(model, 2)) < kInlier_px;
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

// Circles of the prior's shape through three edges, or ellipses through five.
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
  const double weak = 1e-6;
  for (int i = 0; i < 5; ++i) {
    const double w = i >= 3 && edges == 3 ? 1e6 : weak * prior.weight[i];
    a(i, i) += w;
    b[i] += w * prior.mean[i];
  }
  model = a.ldlt().solve(b);
  for (int i = 0; i < 5; ++i) {
    const double deviations = (model[i] - prior.mean[i]) * std::sqrt(prior.weight[i]) / kEdge_px;
    if (!(std::abs(deviations) < 4)) return false;
  }
  return true;
}

Vector5 consensus(const Profiles& p, const Regular& prior, double wide, bool ellipse) {
  Vector5 best = optimise(p, prior.mean, wide, prior);
  if (support(p, best) > kTrusted || p.rays.size() < 15) return best;
  double lowest = cost(p, best, kInlier_px), lowest_seed = cost(p, best, 0.25 * wide + kInlier_px);
  Lottery lottery;
  for (int trial = 0; trial < kHypotheses; ++trial) {
    Vector5 seed;
    if (!hypothesis(p, prior, ellipse && trial % 2 ? 5 : 3, lottery, seed)) continue;
    const double seed_cost = cost(p, seed, 0.25 * wide + kInlier_px);
    if (seed_cost > 1.02 * lowest_seed) continue;
    lowest_seed = std::min(lowest_seed, seed_cost);
    const Vector5 model = optimise(p, seed, 0.5 * wide + kInlier_px, prior);
    const double model_cost = cost(p, model, kInlier_px);
    if (model_cost < lowest) {
      lowest = model_cost;
      best = model;
    }
  }
  return best;
}

// The edge's width: contrast over steepest slope. The median over the rays that agree.
double edge_blur(Profiles& p, const Rim& rim, const Vector5& model, bool bright) {
  p.scratch.clear();
  const float sign = bright ? 1.0f : -1.0f;
  for (std::size_t i = 0; i < p.rays.size(); ++i) {
    const Ray& ray = p.rays[i];
    if (std::abs(ray.residual(model, 2)) > kInlier_px) continue;
    const float* s = p.samples.data() + i * p.length;
    const double at = ray.model(model) - rim.radius_at(ray.cos2, ray.sin2) - p.first;
    const int k = static_cast<int>(std::lround(at));
    if (k < 4 || k + 4 >= p.valid[i]) continue;
    float steepest = 0;
    for (int m = k - 2; m < k + 2; ++m) steepest = std::max(steepest, sign * (s[m] - s[m + 1]));
    const float contrast = sign * (s[k - 4] - s[k + 4]);
    if (steepest > 0 && contrast > 0) p.scratch.push_back(contrast / steepest);
  }
  if (p.scratch.size() < 8) return 1;
  const auto middle = p.scratch.begin() + static_cast<std::ptrdiff_t>(p.scratch.size() / 2);
  std::nth_element(p.scratch.begin(), middle, p.scratch.end());
  return *middle / std::sqrt(2 * kPi);
}

RimSearch search_one(Profiles& p, const Rim& start, const Regular& prior, double wide, bool bright,
                     bool ellipse) {
  RimSearch result;
  result.bright = bright;
  result.in_view = static_cast<double>(p.in_view) / p.cast;
  find_edges(p, start, bright);
  if (p.rays.size() < 12) return result;
  const Vector5 model = consensus(p, prior, wide, ellipse);
  result.support = support(p, model);
  // The linear model's second order: a circle d away from the rays' centre is d²/4R larger.
  const double d_sq = model[0] * model[0] + model[1] * model[1];
  result.rim = {start.cx + model[0], start.cy + model[1], model[2] + d_sq / (4 * start.r), model[3],
                model[4]};
  result.found = result.rim.r > 2 && result.support > 0.08 &&
                 std::hypot(model[3], model[4]) < 0.3 * result.rim.r;
  if (result.found) result.blur_px = edge_blur(p, start, model, bright);
  return result;
}

}  // namespace

RimSearch search_rim(const Frame& frame, const CirclePrior& prior, const CircleOptions& options) {
  const double radius = prior.predicted.r_px;
  const Rim start{prior.predicted.cx_px, prior.predicted.cy_px, radius, prior.e1_px, prior.e2_px};
  const double rim_sd = prior.rim_sd_px.value_or(kRimSdOfRadius * radius);
  // Far enough for three deviations of everything, and for two levels beside the edge.
  const double wide = 3 * std::hypot(prior.centre_sd_px, rim_sd) + kInlier_px;
  const double outward = wide + 4;
  const double inward = std::min(wide + 4, radius - 1);
  const int count = std::max(90, options.rays / 4);

  thread_local Profiles profiles;  // memory only
  if (frame.type == PixelType::u8) {
    sample_rays(frame.u8.view(), start, inward, outward, count, profiles);
  } else {
    sample_rays(frame.u16.view(), start, inward, outward, count, profiles);
  }

  Regular regular;
  regular.mean << 0, 0, radius, prior.e1_px, prior.e2_px;
  const double centre = kEdge_px / std::max(prior.centre_sd_px, 0.05);
  const double shape = kEdge_px / std::max(rim_sd, 0.05);
  const double fixed = options.allow_ellipse ? shape : 1e3;
  regular.weight << centre * centre, centre * centre, shape * shape, fixed * fixed, fixed * fixed;

  const bool bright = prior.bright.value_or(looks_bright(profiles));
  RimSearch first = search_one(profiles, start, regular, wide, bright, options.allow_ellipse);
  if (prior.bright || first.support > kTrusted) return first;
  RimSearch second = search_one(profiles, start, regular, wide, !bright, options.allow_ellipse);
  return second.support > first.support ? second : first;
}

}  // namespace impactdic::circle
