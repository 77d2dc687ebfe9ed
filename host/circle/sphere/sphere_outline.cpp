// The outline of a ball before an even background: where each ray leaves the background, whether to
// the brighter or to the darker. A sphere that is lit from the front has a rim with paint hardly
// brighter than what lies behind it and ink that is darker, so that no polarity and no level of the
// paint tell its rim; but neither looks like the background.
#include <impactdic/units.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "host/circle/rays/ground_plane.h"
#include "host/circle/rays/rim_rays.h"
#include "host/circle/rim/rim.h"
#include "host/circle/rim/rim_levels.h"
#include "host/circle/settings/crossings.h"
#include "host/circle/settings/outline.h"

namespace impactdic::circle {
namespace {

constexpr int kOutlineSectors = kLevelSectors;
constexpr int kIn = 4, kOut = 4, kLength = kIn + 1 + kOut;  // samples of a ray about the rim

struct OutlineRays {
  std::vector<float> cos, sin, profile;
  std::vector<int> ray;
  std::array<std::vector<float>, kOutlineSectors> ground;
  std::vector<float> scratch;

  const float* row(int i) const { return profile.data() + static_cast<std::size_t>(i) * kLength; }
};

template <typename T>
void cast(ImageView<const T> picture, const Rim& rim, float step, int count, OutlineRays& rays) {
  const Sampler<T> sampler(picture);
  rays.cos.clear();
  rays.sin.clear();
  rays.ray.clear();
  rays.profile.clear();
  for (auto& sector : rays.ground) sector.clear();
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * kPi * i / count, c = std::cos(angle), s = std::sin(angle);
    const double radius = rim.radius_at(c * c - s * s, 2 * c * s);
    const auto x = static_cast<float>(rim.cx + radius * c);
    const auto y = static_cast<float>(rim.cy + radius * s);
    const float dx = step * static_cast<float>(c), dy = step * static_cast<float>(s);
    if (!sampler.inside(x - kIn * dx, y - kIn * dy, 2)) continue;
    if (!sampler.inside(x + kOut * dx, y + kOut * dy, 2)) continue;
    for (int k = -kIn; k <= kOut; ++k) {
      const float level = sampler.template bicubic<Kernel::kSmooth>(x + static_cast<float>(k) * dx,
                                                                    y + static_cast<float>(k) * dy);
      rays.profile.push_back(level);
      if (k >= kCrossing.ground_from) rays.ground[i * kOutlineSectors / count].push_back(level);
    }
    rays.cos.push_back(static_cast<float>(c));
    rays.sin.push_back(static_cast<float>(s));
    rays.ray.push_back(i);
  }
}

// Median of what lies outside, over three sectors; and the noise of a sample there.
struct Background {
  std::array<float, kOutlineSectors> level{};
  float noise = 0;
};

Background background_of(OutlineRays& rays) {
  Background back;
  for (int b = 0; b < kOutlineSectors; ++b) {
    rays.scratch.clear();
    for (int d = -1; d <= 1; ++d) {
      const auto& sector = rays.ground[(b + d + kOutlineSectors) % kOutlineSectors];
      rays.scratch.insert(rays.scratch.end(), sector.begin(), sector.end());
    }
    if (!rays.scratch.empty()) back.level[b] = quantile(rays.scratch, 0.5);
  }
  rays.scratch.clear();
  for (int b = 0; b < kOutlineSectors; ++b) {
    for (const float level : rays.ground[b]) {
      rays.scratch.push_back(std::abs(level - back.level[b]));
    }
  }
  if (!rays.scratch.empty()) back.noise = kLevels.noise_per_median * quantile(rays.scratch, 0.5);
  return back;
}

// Half-way of the step from the background to what the ray meets first.
struct Departure {
  float at;    // steps from the expected rim
  float step;  // grey levels
};

bool depart(const float* p, float ground, float least, Departure& out) {
  for (int k = kLength - 2; k >= 2; --k) {
    const float here = p[k] - ground;
    if (std::abs(here) < least) continue;
    const float sign = here > 0 ? 1.0f : -1.0f;
    // The first stretch that is not background, as far as it goes on.
    float most = sign * here;
    for (int m = k - 1; m >= std::max(0, k - kOutline.stretch); --m) {
      const float level = sign * (p[m] - ground);
      if (level < most) break;
      most = level;
    }
    int outer = k;
    while (outer > 0 && sign * (p[outer] - ground) < 0.5f * most) --outer;
    const float inside = sign * (p[outer] - ground), outside = sign * (p[outer + 1] - ground);
    if (!(inside > outside)) return false;
    out.at = static_cast<float>(outer - kIn) + (inside - 0.5f * most) / (inside - outside);
    out.step = sign * most;
    return true;
  }
  return false;
}

// Light that falls off across the picture, as a plane through what lies at the rays' outer ends,
// taken off: along a ray it would be no background. An obstacle makes no plane.
void level_out(const Rim& rim, Profiles& p) {
  struct End {
    double x, y, level;
  };
  const int n = static_cast<int>(p.rays.size()), from = outer_end(p);
  std::vector<End> ends;
  PlaneSums sums;
  double mean = 0;
  for (int i = 0; i < n; ++i) {
    if (p.valid[i] <= from) continue;
    const float* s = p.samples.data() + static_cast<std::ptrdiff_t>(i) * p.length;
    p.scratch.assign(s + from, s + p.valid[i]);
    const Ray& ray = p.rays[i];
    const double out = rim.radius_at(ray.cos2, ray.sin2) + p.first + (from + p.valid[i] - 1) / 2.0;
    const auto level = static_cast<double>(upper_median(p.scratch));
    ends.push_back({out * ray.cos, out * ray.sin, level});
    sums.add(ends.back().x, ends.back().y, level);
    mean += level;
  }
  if (static_cast<int>(ends.size()) < kOutline.least_across) return;
  mean /= static_cast<double>(ends.size());
  const GroundPlane plane = sums.plane();
  double flat = 0, left = 0;  // squares about the mean, and about the plane
  for (const End& end : ends) {
    flat += std::pow(end.level - mean, 2);
    left += std::pow(end.level - plane.at(end.x, end.y), 2);
  }
  if (!(left < kOutline.across * kOutline.across * flat)) return;
  for (int i = 0; i < n; ++i) {
    const Ray& ray = p.rays[i];
    float* s = p.samples.data() + static_cast<std::ptrdiff_t>(i) * p.length;
    const double per_px = plane.x_px * ray.cos + plane.y_px * ray.sin;
    const double first = rim.radius_at(ray.cos2, ray.sin2) + p.first;
    for (int k = 0; k < p.valid[i]; ++k) s[k] -= static_cast<float>(per_px * (first + k));
  }
}

}  // namespace

Behind behind(const Rim& rim, Profiles& p) {
  level_out(rim, p);
  const int n = static_cast<int>(p.rays.size()), from = outer_end(p);
  Behind back;
  std::vector<float> off;
  for (int i = 0; i < n; ++i) {
    p.scratch.clear();
    for (int d = -kOutline.beside; d <= kOutline.beside; ++d) {
      const int at = (i + d + n) % n;
      const float* s = p.samples.data() + static_cast<std::ptrdiff_t>(at) * p.length;
      p.scratch.insert(p.scratch.end(), s + std::min(from, p.valid[at]), s + p.valid[at]);
    }
    back.level.push_back(p.scratch.empty() ? 0 : upper_median(p.scratch));
    const float* s = p.samples.data() + static_cast<std::ptrdiff_t>(i) * p.length;
    for (int k = from; k < p.valid[i]; ++k) off.push_back(std::abs(s[k] - back.level.back()));
  }
  if (!off.empty()) back.noise = kLevels.noise_per_median * upper_median(off);
  return back;
}

void find_departures(Profiles& p, const Rim& rim) {
  const int n = static_cast<int>(p.rays.size()), from = outer_end(p);
  const Behind back = behind(rim, p);
  const float least = kOutline.noises_of_two * back.noise;
  for (int i = 0; i < n; ++i) {
    Ray& ray = p.rays[i];
    ray.edges = 0;
    const float* s = p.samples.data() + static_cast<std::ptrdiff_t>(i) * p.length;
    const auto background = [&](int k) { return std::abs(s[k] - back.level[i]) < least; };
    if (p.valid[i] <= from) continue;
    int k = p.valid[i] - 1;
    while (k > 1 && (background(k) || background(k - 1))) --k;
    if (k == p.valid[i] - 1 || k <= 1) continue;
    ray.rho[ray.edges++] = rim.radius_at(ray.cos2, ray.sin2) + p.first + k + 0.5;
  }
}

void trace_outline(const Frame& frame, const Rim& rim, double blur_px, int count, RimTrace& trace) {
  thread_local OutlineRays rays;  // memory only
  const auto step = static_cast<float>(step_px_of(blur_px, rim.r));
  if (frame.type == PixelType::kU8) {
    cast(frame.u8.view(), rim, step, count, rays);
  } else {
    cast(frame.u16.view(), rim, step, count, rays);
  }
  const int n = static_cast<int>(rays.ray.size());
  trace.points.clear();
  trace.rays_in_view = n;
  trace.edge_sigma_px = 0;
  if (n < kCrossing.least_rays) return;
  const Background back = background_of(rays);
  const float least = kOutline.noises * back.noise + kOutline.least_level;
  std::vector<Departure> found(static_cast<std::size_t>(n));
  rays.scratch.clear();
  for (int i = 0; i < n; ++i) {
    Departure& d = found[static_cast<std::size_t>(i)];
    d.step = 0;
    if (depart(rays.row(i), back.level[rays.ray[i] * kOutlineSectors / count], least, d)) {
      rays.scratch.push_back(std::abs(d.step));
    }
  }
  if (rays.scratch.empty()) return;
  const double usual = quantile(rays.scratch, 0.5);
  trace.edge_sigma_px = blur_px;
  const auto error = [&](double contrast) {
    return std::hypot(back.noise / contrast * std::sqrt(2 * kPi) * blur_px, kCrossing.phase_px[0]);
  };
  trace.noise_px = error(usual);
  for (int i = 0; i < n; ++i) {
    const Departure& d = found[static_cast<std::size_t>(i)];
    if (d.step == 0) continue;
    trace.points.push_back({rays.cos[i], rays.sin[i], step * d.at,
                            static_cast<float>(trace.noise_px / error(std::abs(d.step))),
                            rays.ray[i] * kRimSectors / count});
  }
}

// Weights by Tukey's biweight (Holland and Welsch, 1977); deviations from how the sectors of the
// rim differ, for the points of a sector err alike.
RimFit fit_outline(const RimTrace& trace, const Rim& rim) {
  using Vector3 = Eigen::Vector3d;
  using Matrix3 = Eigen::Matrix3d;
  RimFit fit;
  fit.rim = rim;
  const std::vector<RimPoint>& points = trace.points;
  if (points.size() < kCrossingFit.least_points) return fit;
  std::vector<float> off(points.size());
  const auto jacobian = [](const RimPoint& p) { return Vector3{p.cos, p.sin, 1}; };
  Vector3 delta = Vector3::Zero();
  Matrix3 square = Matrix3::Identity();
  double scale = 1, reach = 1;
  const auto residuals = [&] {
    for (std::size_t i = 0; i < points.size(); ++i) {
      off[i] = std::abs(points[i].excess - static_cast<float>(jacobian(points[i]).dot(delta)));
    }
    std::vector<float> sorted = off;
    scale = std::max(kOutline.least_scale_px,
                     static_cast<double>(kLevels.noise_per_median * quantile(sorted, 0.5)));
    reach = kOutline.biweight * scale;
  };
  const auto weight = [&](std::size_t i) {
    const double u = static_cast<double>(off[i]) / reach;
    return u < 1 ? (1 - u * u) * (1 - u * u) : 0.0;
  };
  for (int pass = 0; pass < kOutline.passes; ++pass) {
    residuals();
    square = 1e-9 * Matrix3::Identity();
    Vector3 sum = Vector3::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vector3 j = jacobian(points[i]);
      square += weight(i) * j * j.transpose();
      sum += weight(i) * static_cast<double>(points[i].excess) * j;
    }
    delta = square.ldlt().solve(sum);
  }
  residuals();
  std::array<Vector3, kRimSectors> scores;
  scores.fill(Vector3::Zero());
  std::array<bool, kRimSectors> seen{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector3 j = jacobian(points[i]);
    scores[points[i].sector] +=
        weight(i) * (static_cast<double>(points[i].excess) - j.dot(delta)) * j;
    if (weight(i) < 0.5) continue;
    ++fit.points;
    seen[points[i].sector] = true;
  }
  Matrix3 scatter = Matrix3::Zero();
  for (const Vector3& score : scores) scatter += score * score.transpose();
  const Matrix3 inverse = square.inverse();
  const Matrix3 covariance = inverse * scatter * inverse;
  fit.ok = delta.allFinite();
  fit.rim = {rim.cx + delta[0], rim.cy + delta[1], rim.r + delta[2], 0, 0};
  for (int i = 0; i < 3; ++i) fit.sd[i] = std::sqrt(std::max(0.0, covariance(i, i)));
  for (int i = 0; i < 2; ++i) fit.with_radius[i] = inverse(i, 2) / inverse(2, 2);
  fit.residual_px = scale;
  fit.arc = static_cast<double>(std::count(seen.begin(), seen.end(), true)) / kRimSectors;
  return fit;
}

}  // namespace impactdic::circle
