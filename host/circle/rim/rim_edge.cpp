// The sub-pixel edge of each ray that crosses the rim cleanly: bicubic profile, local half level.
#include <impactdic/units.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "host/circle/rim/rim.h"
#include "host/circle/rim/rim_levels.h"
#include "host/circle/settings/crossings.h"
#include "host/circle/settings/levels.h"

namespace impactdic::circle {
namespace {

constexpr int kSectors = kLevelSectors;
constexpr int kHalf = 3;  // a profile is 2·kHalf + 1 samples about the expected rim
constexpr int kLength = 2 * kHalf + 1;

struct Rays {
  std::vector<float> cos, sin;                      // all rays in view
  std::vector<int> ray;                             // number of the ray, 0 … count − 1
  std::vector<float> profile;                       // (rays, kLength), from inside to outside
  std::array<std::vector<float>, kSectors> ground;  // samples 2 … 4 steps outside, by sector
  std::vector<float> ball, outside;                 // levels at each ray
  std::vector<float> scratch;

  void resize(int n) {
    ball.resize(n);
    outside.resize(n);
    cos.resize(n);
    sin.resize(n);
    ray.resize(n);
    profile.resize(static_cast<std::size_t>(n) * kLength);
    for (auto& sector : ground) sector.clear();
  }
  const float* row(int i) const { return profile.data() + static_cast<std::size_t>(i) * kLength; }
};

// A crossing of the half level.
struct Edge {
  int index;       // into Rays
  float at;        // steps from the expected rim
  float fall;      // of the contrast, from one step inside the crossing to one outside
  float contrast;  // of the usual
};

// Noise of one profile sample: from ray to ray outside the ball, where nothing else changes.
float sample_noise(Rays& rays, int n) {
  rays.scratch.clear();
  for (int i = 3; i < n; i += 3) {
    rays.scratch.push_back(std::abs(rays.row(i)[kLength - 1] - rays.row(i - 3)[kLength - 1]));
  }
  return noise_of_steps(rays.scratch);
}

// The same where that is what the background's texture changes by: what bends from ray to ray.
float camera_noise(Rays& rays, int n, double per_ray_px, float noise) {
  const int apart = std::max(1, static_cast<int>(std::lround(kUnevenGround.apart_px / per_ray_px)));
  rays.scratch.clear();
  for (int i = apart; i + apart < n; ++i) {
    rays.scratch.push_back(std::abs(rays.row(i - apart)[kLength - 1] -
                                    2 * rays.row(i)[kLength - 1] +
                                    rays.row(i + apart)[kLength - 1]));
  }
  const float bends = noise_of_steps(rays.scratch) / std::sqrt(3.0f);
  return bends < kUnevenGround.bends * noise ? bends : noise;
}

// The background's level by sector: the median of what lies 2 … 4 steps outside, over three
// sectors.
std::array<float, kSectors> ground_levels(Rays& rays) {
  std::array<float, kSectors> levels{};
  for (int b = 0; b < kSectors; ++b) {
    rays.scratch.clear();
    for (int d = -1; d <= 1; ++d) {
      const auto& sector = rays.ground[(b + d + kSectors) % kSectors];
      rays.scratch.insert(rays.scratch.end(), sector.begin(), sector.end());
    }
    if (!rays.scratch.empty()) levels[b] = quantile(rays.scratch, 0.5);
  }
  return levels;
}

// The paint's level (see rim_levels.h) through the upper crowd of samples 3 … 13 steps inside. It
// starts from what one sample in twenty exceeds in each sector, and settles on what lies within a
// window about it that shrinks to the noise.
class RayLight {
 public:
  static constexpr int kDepths = 6;
  // Samples of one ray, 3, 5 … 13 steps inside; (x, y) is the place of their middle, in radii from
  // the centre, and `step` a step in the same unit.
  struct Column {
    float x, y, step;
    float per_distance;  // one over that of the place from the centre
    int ray;
    std::array<float, kDepths> level;
  };
  static float depth(int k) { return static_cast<float>(3 + 2 * k); }
  static constexpr float kMiddle = 8;

  void clear() { columns_.clear(); }
  void add(const Column& column) { columns_.push_back(column); }

  // `ground` is the background's level.
  void fit(float ground, float noise, int rays, std::vector<float>& scratch) {
    find_bright(rays, scratch);
    find_envelope(ground);
    const float contrast = static_cast<float>(w_[0]) - ground;
    for (const float window : settling_windows(contrast, noise)) settle(window);
  }
  float at(float c, float s) const { return static_cast<float>(w_.dot(basis(c, s))); }

 private:
  using Vector5 = Eigen::Matrix<double, 5, 1>;
  using Matrix5 = Eigen::Matrix<double, 5, 5>;
  struct Bright {
    float x, y, level;
  };
  static Vector5 basis(double x, double y) { return {1, x, y, x * x - y * y, 2 * x * y}; }

  // What one sample in twenty exceeds, by sector.
  void find_bright(int rays, std::vector<float>& scratch) {
    sectors_ = 0;
    std::size_t first = 0;
    for (int sector = 0; sector < kSectors; ++sector) {  // columns come in the order of the rays
      scratch.clear();
      const std::size_t begin = first;
      while (first < columns_.size() && columns_[first].ray * kSectors / rays == sector) {
        const auto& level = columns_[first++].level;
        scratch.insert(scratch.end(), level.begin(), level.end());
      }
      if (scratch.size() < kCrossing.sector_samples) continue;
      const Column& middle = columns_[(begin + first) / 2];
      bright_[sectors_++] = {middle.x, middle.y, quantile(scratch, kLevels.bright)};
    }
  }

  // Upper envelope of the sectors.
  void find_envelope(float ground) {
    w_.setZero();
    for (int pass = 0; pass < kLevels.envelope_passes; ++pass) {
      Matrix5 a = Matrix5::Zero();
      for (int m = 0; m < 5; ++m) a(m, m) = no_shading(m);
      Vector5 b = Vector5::Zero();
      for (int k = 0; k < sectors_; ++k) {
        const Vector5 j = basis(bright_[k].x, bright_[k].y);
        const double off = bright_[k].level - w_.dot(j);
        const bool above = pass == 0 || off > -kLevels.below * (w_[0] - ground);
        const double weight = above ? 1 : kLevels.below_weight;
        a.noalias() += weight * j * j.transpose();
        b.noalias() += weight * bright_[k].level * j;
      }
      w_ = a.ldlt().solve(b);
    }
  }

  void settle(float window) {
    Matrix5 a = Matrix5::Zero();
    for (int m = 0; m < 5; ++m) a(m, m) = kLevels.held;
    Vector5 b = a * w_;
    for (const Column& column : columns_) {
      const Vector5 j = basis(column.x, column.y);
      const float expected = static_cast<float>(w_.dot(j));
      // The light changes along the ray as the place does.
      const float slope =
          (expected - static_cast<float>(w_[0])) * column.step * column.per_distance;
      float sum = 0;
      int n = 0;
      for (int k = 0; k < kDepths; ++k) {
        const float level = column.level[k] - slope * (kMiddle - depth(k));
        const bool near = std::abs(level - expected) <= window;
        sum += near ? level : 0;
        n += near;
      }
      for (int p = 0; p < 5; ++p) {
        for (int q = 0; q <= p; ++q) a(p, q) += n * j[p] * j[q];
        b[p] += j[p] * sum;
      }
    }
    w_ = a.ldlt().solve(b);  // reads the lower triangle
  }

  std::vector<Column> columns_;
  std::array<Bright, kSectors> bright_;
  int sectors_ = 0;
  Vector5 w_ = Vector5::Zero();
};

// A ray that crosses the expected rim at (x, y) in the direction (ux, uy), `radius` px from the
// centre; samples lie `step` px apart.
struct Crossing {
  float x, y, ux, uy, radius;
  float step;
  int ray, sector;
};

// The levels outside and deep inside at a ray.
template <typename T>
void take_levels(const Sampler<T>& sampler, const Crossing& at, float sign, double r_px, Rays& rays,
                 RayLight& light) {
  const float dx = at.step * at.ux, dy = at.step * at.uy;
  const auto level = [&](float out_px) {
    return sign * sampler.bilinear(at.x + out_px * at.ux, at.y + out_px * at.uy);
  };
  const float margin = kCrossing.margin_px;
  for (int k = kCrossing.ground_from; k <= kCrossing.ground_to; ++k) {
    if (!sampler.inside(at.x + k * dx, at.y + k * dy, margin)) break;
    rays.ground[at.sector].push_back(level(k * at.step));
  }
  // The steps are shorter on a ball so small that they would reach its centre.
  const float inward = std::min(at.step, static_cast<float>(r_px) / kCrossing.per_r);
  const float deepest = RayLight::depth(RayLight::kDepths - 1) * inward;
  if (!sampler.inside(at.x - deepest * at.ux, at.y - deepest * at.uy, margin)) return;
  const float per_radius = 1 / static_cast<float>(r_px);
  const float middle = per_radius * (at.radius - RayLight::kMiddle * inward);
  RayLight::Column column{middle * at.ux, middle * at.uy, inward * per_radius,
                          1 / middle,     at.ray,         {}};
  for (int k = 0; k < RayLight::kDepths; ++k) {
    column.level[k] = level(-RayLight::depth(k) * inward);
  }
  light.add(column);
}

// Casts the rays; returns how many lie in the picture. `sign` makes every ball bright.
template <Kernel kKernel, typename T>
int cast(ImageView<const T> picture, const Rim& rim, float sign, float step, int count, Rays& rays,
         RayLight& light) {
  const Sampler<T> sampler(picture);
  rays.resize(count);
  const double turn_c = std::cos(2 * kPi / count), turn_s = std::sin(2 * kPi / count);
  double c = 1, s = 0;
  int n = 0;
  for (int i = 0; i < count; ++i) {
    const double radius = rim.radius_at(c * c - s * s, 2 * c * s);
    const float x = static_cast<float>(rim.cx + radius * c);
    const float y = static_cast<float>(rim.cy + radius * s);
    const float dx = step * static_cast<float>(c), dy = step * static_cast<float>(s);
    if (sampler.inside(x - kHalf * dx, y - kHalf * dy, 2) &&
        sampler.inside(x + kHalf * dx, y + kHalf * dy, 2)) {
      float* p = rays.profile.data() + static_cast<std::size_t>(n) * kLength;
      for (int k = -kHalf; k <= kHalf; ++k) {
        const float px = x + static_cast<float>(k) * dx, py = y + static_cast<float>(k) * dy;
        p[k + kHalf] = sign * sampler.template bicubic<kKernel>(px, py);
      }
      if (i % kCrossing.levels_every == 0) {
        const Crossing at{
            x,    y, static_cast<float>(c), static_cast<float>(s), static_cast<float>(radius),
            step, i, i * kSectors / count};
        take_levels(sampler, at, sign, rim.r, rays, light);
      }
      rays.cos[n] = static_cast<float>(c);
      rays.sin[n] = static_cast<float>(s);
      rays.ray[n] = i;
      ++n;
    }
    const double next = c * turn_c - s * turn_s;
    s = s * turn_c + c * turn_s;
    c = next;
  }
  return n;
}

// The background at a ray whose samples outside read `seen`.
float ground_at(const std::array<float, kSectors>& levels, int ray, int count, float seen,
                float contrast) {
  const float at = static_cast<float>(ray) * kSectors / static_cast<float>(count) - 0.5f;
  const int b = static_cast<int>(std::floor(at));
  const float t = at - static_cast<float>(b);
  const float a = levels[(b + kSectors) % kSectors], c = levels[(b + 1) % kSectors];
  return ground_between(a, c, t, seen, contrast);
}

// Where the profile falls through `level`, in steps from the expected rim; outermost, within two
// steps. Cubic through the four samples about it.
bool cross(const float* p, float level, float& at) {
  for (int k = kHalf + 2; k > kHalf - 2; --k) {
    if (p[k - 1] < level || p[k] >= level) continue;
    // On [k−1, k] with t in [0, 1], Lagrange's cubic through k−2 … k+1.
    const float a = p[k - 2], b = p[k - 1], c = p[k], d = p[k + 1];
    const float c1 = -a / 3 - b / 2 + c - d / 6;
    const float c2 = a / 2 - b + c / 2;
    const float c3 = -a / 6 + b / 2 - c / 2 + d / 6;
    float t = (b - level) / (b - c);
    for (int pass = 0; pass < kCrossing.newton; ++pass) {
      const float f = b - level + t * (c1 + t * (c2 + t * c3));
      const float slope = c1 + t * (2 * c2 + t * 3 * c3);
      if (!(slope < 0)) return false;
      t -= f / slope;
    }
    if (t < -0.5f || t > 1.5f) return false;
    at = static_cast<float>(k - 1 - kHalf) + t;
    return true;
  }
  return false;
}

float profile_at(const float* p, float at) {
  const float u = at + kHalf;
  const int k = std::clamp(static_cast<int>(u), 1, kLength - 3);
  const float t = u - static_cast<float>(k);
  const float a = p[k - 1], b = p[k], c = p[k + 1], d = p[k + 2];
  return b + 0.5f * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
}

// A background that changes from pixel to pixel: its level at each edge.
class UnevenGround {
 public:
  // nullopt where it changes within sectors by no more than noise does.
  static std::optional<UnevenGround> find(Rays& rays, int n, float noise) {
    rays.scratch.clear();
    for (int i = 0; i < n; ++i) {
      rays.scratch.push_back(std::abs(rays.row(i)[kLength - 1] - rays.outside[i]));
    }
    const float scatter = kLevels.noise_per_median * quantile(rays.scratch, 0.5);
    if (!(scatter > kUnevenGround.noises * noise)) return std::nullopt;
    return UnevenGround(rays, n, usual_fall(rays, n));
  }
  // Just outside the edge of ray `i`, along the line through what it and the rays beside it show
  // farther out.
  float beside(int i) const {
    constexpr float kOut = static_cast<float>(kHalf) - kUnevenGround.outside_steps;
    float sum = 0;
    int count = 0;
    for (int k = std::max(0, i - kUnevenGround.beside);
         k <= std::min(n_ - 1, i + kUnevenGround.beside); ++k) {
      if (rays_->ray[k] - rays_->ray[i] != k - i) continue;
      const float* p = rays_->row(k);
      sum += p[kLength - 1] + kOut * (fall(p) - usual_fall_);
      ++count;
    }
    return sum / static_cast<float>(count);
  }

 private:
  UnevenGround(const Rays& rays, int n, float usual_fall)
      : rays_(&rays), n_(n), usual_fall_(usual_fall) {}
  static float fall(const float* p) { return p[kLength - 2] - p[kLength - 1]; }

  // A blurred edge reaches to the nearer of the two samples outside; not where ink has moved it
  // inwards.
  static float usual_fall(Rays& rays, int n) {
    std::vector<std::pair<float, float>> falls;  // with where the edge is
    for (int i = 0; i < n; ++i) {
      const float* p = rays.row(i);
      float at = 0;
      if (cross(p, 0.5f * (rays.ball[i] + rays.outside[i]), at)) falls.emplace_back(at, fall(p));
    }
    rays.scratch.clear();
    for (const auto& [at, fall] : falls) rays.scratch.push_back(at);
    if (falls.empty()) return 0;
    const float middle = quantile(rays.scratch, 0.5);
    rays.scratch.clear();
    for (const auto& [at, fall] : falls) {
      if (at >= middle) rays.scratch.push_back(fall);
    }
    return quantile(rays.scratch, 0.5);
  }

  const Rays* rays_;
  int n_;
  float usual_fall_;
};

// The crossings of the rays that show the background outside as their neighbourhood has it: drops
// the bar and whatever else hides the ball or the background. `relative_noise` gets the noise of a
// sample over the contrast.
void find_edges(Rays& rays, RayLight& light, int n, int count, double r_px,
                std::vector<Edge>& edges, float& relative_noise) {
  constexpr int kBeside = kClear.beside;
  edges.clear();
  const float noise = sample_noise(rays, n);
  const float of_camera = camera_noise(rays, n, 2 * kPi * r_px / count, noise);
  const auto grounds = ground_levels(rays);
  const float ground = quantile(grounds, 0.5);
  light.fit(ground, of_camera, count, rays.scratch);
  const float usual = light.at(0, 0) - ground;
  relative_noise = of_camera / std::max(usual, 1e-6f);
  for (int i = 0; i < n; ++i) {
    rays.ball[i] = light.at(rays.cos[i], rays.sin[i]);
    const float seen = rays.row(i)[kLength - 1];
    rays.outside[i] = ground_at(grounds, rays.ray[i], count, seen, std::max(usual, 1e-6f));
  }
  const auto uneven = UnevenGround::find(rays, n, of_camera);
  int blocked = -kBeside - 1;  // the last ray with something else outside
  for (int i = 0; i < n; ++i) {
    const float* p = rays.row(i);
    const float ball = rays.ball[i], outside = rays.outside[i];
    const float contrast = ball - outside;
    Edge edge{i, 0, 0, contrast / usual};
    if (!is_clear(contrast, usual, p[kLength - 1], outside, noise)) {
      blocked = i;
      while (!edges.empty() && edges.back().index >= i - kBeside) edges.pop_back();
      continue;
    }
    if (i - blocked <= kBeside) continue;
    const float beside = uneven ? uneven->beside(i) : outside;
    if (!cross(p, 0.5f * (ball + beside), edge.at)) continue;
    const float beyond = profile_at(p, edge.at + kCrossing.beyond_steps) - outside;
    if (std::abs(beyond) > kClear.ground_tolerance * contrast + kCrossing.beyond_noise * noise) {
      continue;
    }
    edge.fall = (profile_at(p, edge.at - 1) - profile_at(p, edge.at + 1)) / contrast;
    edges.push_back(edge);
  }
}

// Width of the edge as a Gaussian's σ: the level falls by Φ(1/σ) − Φ(−1/σ) over two steps.
double edge_sigma(const std::vector<Edge>& edges, std::vector<float>& scratch, double step) {
  scratch.clear();
  for (const Edge& edge : edges) scratch.push_back(edge.fall);
  if (scratch.empty()) return 0;
  const double fall = std::clamp(static_cast<double>(quantile(scratch, 0.5)), kCrossing.least_fall,
                                 kCrossing.most_fall);
  double low = kCrossing.least_sigma, high = kCrossing.most_sigma;
  for (int pass = 0; pass < kCrossing.sigma_halvings; ++pass) {
    const double middle = 0.5 * (low + high);
    (std::erf(1 / (middle * std::sqrt(2.0))) > fall ? low : high) = middle;
  }
  return low * step;
}

}  // namespace

void trace_rim(const Frame& frame, const Rim& rim, const RayRequest& request, RimTrace& trace) {
  thread_local Rays rays;  // memory only
  thread_local std::vector<Edge> edges;
  thread_local RayLight light;
  light.clear();
  const int count = request.rays;
  const bool sharp = request.kernel == Kernel::kSharp;
  const float step = static_cast<float>(step_px_of(request.blur_px, rim.r));
  const float sign = sign_of(request.polarity);
  const auto cast_on = [&](const auto& view) {
    return sharp ? cast<Kernel::kSharp>(view, rim, sign, step, count, rays, light)
                 : cast<Kernel::kSmooth>(view, rim, sign, step, count, rays, light);
  };
  const int n = frame.type == PixelType::kU8 ? cast_on(frame.u8.view()) : cast_on(frame.u16.view());
  trace.points.clear();
  trace.rays_in_view = n;
  trace.edge_sigma_px = 0;
  if (n < kCrossing.least_rays) return;
  float relative_noise = 0;
  find_edges(rays, light, n, count, rim.r, edges, relative_noise);
  trace.edge_sigma_px = edge_sigma(edges, rays.scratch, step);
  const double noise = relative_noise * std::sqrt(2 * kPi) * trace.edge_sigma_px;
  // Errors grow where the contrast falls.
  const auto error = [&](double contrast) {
    return std::hypot(noise / contrast, kCrossing.phase_px[sharp]);
  };
  const double usual = error(1);
  trace.noise_px = usual;
  for (const Edge& edge : edges) {
    trace.points.push_back({rays.cos[edge.index], rays.sin[edge.index], step * edge.at,
                            static_cast<float>(usual / error(edge.contrast)),
                            rays.ray[edge.index] * kRimSectors / count});
  }
}

}  // namespace impactdic::circle
