// A few rays over the whole range in which a rim may lie, for rim_search.cpp and
// sphere_outline.cpp. Internal to host/circle.
#pragma once

#include <impactdic/units.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "host/circle/rim/rim.h"
#include "host/circle/settings/search.h"

namespace impactdic::circle {

inline constexpr int kEdgesPerRay = 3;  // room for the outermost strong edges of each ray
struct Ray {
  double cos, sin, cos2, sin2;
  int edges = 0;
  std::array<double, kEdgesPerRay> rho;  // distance of each edge from the predicted centre

  double model(const Eigen::Matrix<double, 5, 1>& p) const {
    return p[0] * cos + p[1] * sin + p[2] + p[3] * cos2 + p[4] * sin2;
  }
  // Residual of the edge nearest to the model; `none` where the ray has no edge.
  double residual(const Eigen::Matrix<double, 5, 1>& p, double none) const {
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
    if (sampler.inside(x_rim, y_rim, kRimSearch.in_view_px)) ++p.in_view;
    if (!sampler.inside(x0, y0, kRimSearch.margin_px)) continue;
    const float reach = sampler.reach(x0, y0, dx, dy, kRimSearch.margin_px);
    const int valid = std::min(p.length, static_cast<int>(std::min(reach, 1e6f)) + 1);
    if (valid < kRimSearch.least_samples) continue;
    float* out = p.samples.data() + p.rays.size() * p.length;
    for (int k = 0; k < valid; ++k) {
      const float t = static_cast<float>(k);
      out[k] = sampler.bilinear(x0 + t * dx, y0 + t * dy);
    }
    p.rays.push_back(ray);
    p.valid.push_back(valid);
  }
}

// What lies at the rays' outer ends.
struct Behind {
  std::vector<float> level;  // of each ray, with its neighbours
  float noise = 0;           // of a sample
};
// Samples at and behind this one tell a ray's background.
inline int outer_end(const Profiles& p) { return p.length - p.length / 4; }
// Takes off the samples what light that falls off across the picture makes of the background.
Behind behind(const Rim& rim, Profiles& p);

// Finds where each ray leaves what lies behind the ball.
void find_departures(Profiles& p, const Rim& rim);
// The same where the ball may differ from the background by less than the noise of a sample; false,
// and nothing found, where the background is not even.
bool find_pooled_departures(Profiles& p, const Rim& rim);

}  // namespace impactdic::circle
