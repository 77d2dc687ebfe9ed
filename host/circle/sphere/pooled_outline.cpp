// Where rays leave the background, told by many samples together: what is not background differs
// from it in its mean or in how it scatters, and a part of a rim that hardly does, as the dark side
// of a ball, shows in no single sample. The evidence of a place is the ratio of likelihoods of a
// normal distribution of its own against the background's; the ball ends where the sum of it from
// the inside outwards is greatest.
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/circle/rays/rim_rays.h"
#include "host/circle/rim/rim.h"
#include "host/circle/settings/levels.h"
#include "host/circle/settings/outline.h"

namespace impactdic::circle {
namespace {

// Variance of what lies behind the ball over half the mean square of what neighbouring samples
// differ by: 1 in noise, more in a texture.
double alike(const Profiles& p, const Behind& back) {
  std::vector<float> apart;
  for (std::size_t i = 0; i < p.rays.size(); ++i) {
    const float* s = p.samples.data() + i * static_cast<std::size_t>(p.length);
    for (int k = outer_end(p); k < p.valid[i]; ++k) apart.push_back(std::abs(s[k] - s[k - 1]));
  }
  if (apart.empty()) return 1;
  const double step = kLevels.noise_per_median * upper_median(apart), noise = back.noise;
  return 2 * noise * noise / std::max(step * step, 1e-6);
}

// The samples of a ray pooled with its neighbours', less the background.
struct Pooled {
  std::vector<double> mean, evidence;
  double samples = 1;
};

// Which rays are pooled: so many on either side, each so many on from the last, because noise is
// alike in samples that share pixels.
struct Neighbours {
  int beside = 1, stride = 1;
};

void pool(const Profiles& p, int ray, const Neighbours& near, const Behind& back, Pooled& out) {
  const int n = static_cast<int>(p.rays.size()), rays = 2 * near.beside + 1;
  const int valid = p.valid[ray];
  out.samples = rays;
  out.mean.assign(static_cast<std::size_t>(valid), 0);
  out.evidence.assign(static_cast<std::size_t>(valid), 0);
  const double noise = back.noise, noise_sq = std::max(noise * noise, 1e-6);
  for (int k = 0; k < valid; ++k) {
    double sum = 0, squares = 0;
    for (int d = -near.beside; d <= near.beside; ++d) {
      const int at = (ray + d * near.stride + n) % n;
      const int sample = std::min(k, p.valid[at] - 1);
      const double off =
          static_cast<double>(p.samples[static_cast<std::size_t>(at) * p.length + sample]) -
          static_cast<double>(back.level[ray]);
      sum += off;
      squares += off * off;
    }
    const double mean = sum / rays, square = squares / rays / noise_sq;
    // A few samples scatter little by chance.
    const double variance = std::max(square - mean * mean / noise_sq, kOutline.least_variance);
    const double gain = 0.5 * rays * (square - 1 - std::log(variance));
    const auto at = static_cast<std::size_t>(k);
    out.mean[at] = mean;
    out.evidence[at] = std::min(gain - kOutline.chance, kOutline.most_evidence);
  }
}

// Samples at a ray's outer end, and those of them that are not background.
struct Outside {
  int all = 0, other = 0;
  void add(const Pooled& pooled, int from) {
    for (int k = from; k < static_cast<int>(pooled.evidence.size()); ++k) {
      ++all;
      other += pooled.evidence[static_cast<std::size_t>(k)] > kOutline.other_evidence;
    }
  }
};

// The outermost sample of the ball; −1 where there is none.
int outermost(const Pooled& pooled) {
  double sum = 0, most = 0;
  int last = -1;
  for (std::size_t k = 0; k < pooled.evidence.size(); ++k) {
    sum += pooled.evidence[k];
    if (sum <= most) continue;
    most = sum;
    last = static_cast<int>(k);
  }
  if (last + 1 >= static_cast<int>(pooled.evidence.size())) return -1;
  double inside = 0;
  for (int k = std::max(0, last - kOutline.within + 1); k <= last; ++k) {
    inside += pooled.evidence[static_cast<std::size_t>(k)];
  }
  return inside > kOutline.least_evidence ? last : -1;
}

// A bright ball's edge is seen far out in its blur: the rim is where half of its level is reached.
double half_way(const Pooled& pooled, int last, double noise) {
  const auto off = [&](int k) { return std::abs(pooled.mean[static_cast<std::size_t>(k)]); };
  double peak = 0;
  for (int k = std::max(0, last - kOutline.half_level); k <= last; ++k)
    peak = std::max(peak, off(k));
  if (peak < kOutline.clear_noises * noise / std::sqrt(pooled.samples)) return last + 0.5;
  int k = last + 1;
  while (k > 0 && off(k - 1) < peak / 2) --k;
  if (k == 0) return last + 0.5;
  const double inner = off(k - 1), outer = off(k);
  return k - 1 + (inner - peak / 2) / std::max(inner - outer, 1e-9);
}

}  // namespace

bool find_pooled_departures(Profiles& p, const Rim& rim) {
  const Behind back = behind(rim, p);
  // In so little noise a single sample tells, and blur far outside would be taken for the ball.
  if (kOutline.noises * back.noise < kOutline.least_level) return false;
  if (alike(p, back) > kOutline.alike) return false;
  const int n = static_cast<int>(p.rays.size());
  const double apart_px = 2 * kPi * rim.r / std::max(p.cast, 1);
  Neighbours near;
  near.stride = std::clamp(static_cast<int>(std::ceil(kOutline.apart_px / apart_px)), 1, n / 8 + 1);
  near.beside =
      std::max(kOutline.least_beside,
               static_cast<int>(std::lround(kOutline.pooled_px / (2 * near.stride * apart_px))));
  Pooled pooled;
  Outside outside;
  for (int i = 0; i < n; ++i) {
    Ray& ray = p.rays[i];
    ray.edges = 0;
    // The picture ends before the background is seen.
    if (p.valid[i] <= outer_end(p)) continue;
    pool(p, i, near, back, pooled);
    outside.add(pooled, outer_end(p));
    const int last = outermost(pooled);
    if (last < 1) continue;
    ray.rho[ray.edges++] =
        rim.radius_at(ray.cos2, ray.sin2) + p.first + half_way(pooled, last, back.noise);
  }
  // Beside a texture every departure is chance.
  if (outside.other < kOutline.most_uneven * outside.all) return true;
  for (Ray& ray : p.rays) ray.edges = 0;
  return false;
}

bool trace_pooled_outline(const Frame& frame, const Rim& rim, double blur_px, int count,
                          RimTrace& trace) {
  thread_local Profiles profiles;  // memory only
  const double outward = std::max(kOutline.around_px, kOutline.around_of_r * rim.r);
  const double inward = std::min(outward, rim.r - 1);
  if (frame.type == PixelType::kU8) {
    sample_rays(frame.u8.view(), rim, inward, outward, count, profiles);
  } else {
    sample_rays(frame.u16.view(), rim, inward, outward, count, profiles);
  }
  if (!find_pooled_departures(profiles, rim)) return false;
  trace.points.clear();
  trace.rays_in_view = static_cast<int>(profiles.rays.size());
  trace.edge_sigma_px = blur_px;
  for (const Ray& ray : profiles.rays) {
    if (ray.edges == 0) continue;
    const double turn = std::atan2(ray.sin, ray.cos) / (2 * kPi);
    const auto sector = static_cast<int>((turn < 0 ? turn + 1 : turn) * kRimSectors);
    trace.points.push_back({static_cast<float>(ray.cos), static_cast<float>(ray.sin),
                            static_cast<float>(ray.rho[0] - rim.radius_at(ray.cos2, ray.sin2)), 1,
                            std::min(sector, kRimSectors - 1)});
  }
  return true;
}

}  // namespace impactdic::circle
