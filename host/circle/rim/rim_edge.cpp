// The sub-pixel edge of each ray that crosses the rim cleanly: bicubic profile, local half level.
#include <impactdic/units.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "host/circle/rays/ray_light.h"
#include "host/circle/rays/rays.h"
#include "host/circle/rays/uneven_ground.h"
#include "host/circle/rim/rim.h"
#include "host/circle/rim/rim_levels.h"
#include "host/circle/settings/crossings.h"
#include "host/circle/settings/levels.h"

namespace impactdic::circle {
namespace {

constexpr int kHalf = Rays::kHalf, kLength = Rays::kLength;
constexpr int kSectors = kLevelSectors;

// A crossing of the half level.
struct Edge {
  int index;       // into Rays
  float at;        // steps from the expected rim
  float fall;      // of the contrast, from one step inside the crossing to one outside
  float contrast;  // of the usual
};

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

float profile_at(const float* p, float at) {
  const float u = at + kHalf;
  const int k = std::clamp(static_cast<int>(u), 1, kLength - 3);
  const float t = u - static_cast<float>(k);
  const float a = p[k - 1], b = p[k], c = p[k + 1], d = p[k + 2];
  return b + 0.5f * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
}

struct EdgeLevels {
  float relative_noise = 0;     // of a sample, over the contrast
  float paint = 0, ground = 0;  // negative of a dark ball
  GroundRise rise;
};

// The crossings of the rays that show the background outside as their neighbourhood has it: drops
// the bar and whatever else hides the ball or the background. `textured`: RayRequest::textured.
EdgeLevels find_edges(Rays& rays, RayLight& light, int n, int count, double r_px, bool textured,
                      std::vector<Edge>& edges) {
  constexpr int kBeside = kClear.beside;
  edges.clear();
  const float noise = sample_noise(rays, n);
  const double per_ray_px = 2 * kPi * r_px / count;
  const float of_camera = textured ? camera_noise(rays, n, per_ray_px, noise) : noise;
  const auto grounds = ground_levels(rays);
  const float ground = quantile(grounds, 0.5);
  light.fit(ground, of_camera, count, rays.scratch);
  const float usual = light.at(0, 0) - ground;
  const EdgeLevels levels{of_camera / std::max(usual, 1e-6f), light.at(0, 0), ground,
                          rise_of_ground(grounds, std::max(usual, 1e-6f), middle_of_rays)};
  for (int i = 0; i < n; ++i) {
    rays.ball[i] = light.at(rays.cos[i], rays.sin[i]);
    const float seen = rays.row(i)[kLength - 1];
    rays.outside[i] = ground_at(grounds, rays.ray[i], count, seen, std::max(usual, 1e-6f));
  }
  std::optional<UnevenGround> uneven;
  if (textured) uneven = UnevenGround::find(rays, n, per_ray_px, of_camera);
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
    const float half = uneven ? 0.5f * (ball + uneven->beside(i)) : outside + 0.5f * contrast;
    if (!falls_through(p, half, edge.at)) continue;
    const float beyond = profile_at(p, edge.at + kCrossing.beyond_steps) - outside;
    if (std::abs(beyond) > kClear.ground_tolerance * contrast + kCrossing.beyond_noise * noise) {
      continue;
    }
    edge.fall = (profile_at(p, edge.at - 1) - profile_at(p, edge.at + 1)) / contrast;
    edges.push_back(edge);
  }
  return levels;
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
  trace.edge_sigma_px = trace.brightest = 0;
  trace.rise = {};
  if (n < kCrossing.least_rays) return;
  const EdgeLevels levels = find_edges(rays, light, n, count, rim.r, request.textured, edges);
  trace.brightest = static_cast<double>(sign > 0 ? levels.paint : -levels.ground);
  trace.rise = levels.rise;
  trace.edge_sigma_px = edge_sigma(edges, rays.scratch, step);
  const double noise = levels.relative_noise * std::sqrt(2 * kPi) * trace.edge_sigma_px;
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
