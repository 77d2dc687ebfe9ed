// The sub-pixel edge of each ray that crosses the rim cleanly: bicubic profile, local half level.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "host/base/units.h"
#include "host/track/rim.h"

namespace impactdic {
namespace {

constexpr int kSectors = 24;  // of the rim, over which levels are compared
constexpr int kHalf = 4;      // a profile is 2·kHalf + 1 samples about the expected rim
constexpr int kLength = 2 * kHalf + 1;
constexpr int kSmooth = 6;             // accepted neighbours on either side share a level
constexpr double kSharpest_px = 0.75;  // a wider edge is sampled on proportionally wider steps

struct Rays {
  std::vector<float> cos, sin;  // all rays in view
  std::vector<int> ray;         // number of the ray, 0 … count − 1
  std::vector<float> profile;   // (rays, kLength), from inside to outside
  std::vector<float> in, out;   // levels 2 … 4 steps inside and outside
  std::vector<char> accepted;
  std::vector<float> crossing, near_in, near_out;  // px; level one step inside and outside, 0 … 1
  std::vector<float> scratch;
  std::vector<int> kept;

  void resize(int n) {
    for (auto* v : {&cos, &sin, &in, &out, &crossing, &near_in, &near_out}) v->resize(n);
    ray.resize(n);
    accepted.resize(n);
    profile.resize(static_cast<std::size_t>(n) * kLength);
  }
};

float quantile(std::vector<float>& values, double q) {
  const auto at =
      values.begin() + std::min<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(q * values.size()),
                                                static_cast<std::ptrdiff_t>(values.size()) - 1);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Casts the rays; returns how many lie in the picture. `sign` makes every ball bright.
template <typename T>
int cast(ImageView<const T> picture, const Rim& rim, float sign, float step, int count,
         Rays& rays) {
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
        p[k + kHalf] =
            sign * (std::abs(k) <= 2 ? sampler.bicubic(px, py) : sampler.bilinear(px, py));
      }
      rays.cos[n] = static_cast<float>(c);
      rays.sin[n] = static_cast<float>(s);
      rays.ray[n] = i;
      rays.in[n] = (p[0] + p[1] + p[2]) / 3;
      rays.out[n] = (p[kLength - 1] + p[kLength - 2] + p[kLength - 3]) / 3;
      ++n;
    }
    const double next = c * turn_c - s * turn_s;
    s = s * turn_c + c * turn_s;
    c = next;
  }
  return n;
}

// Marks the rays that show the ball's own level inside and the background's outside, both as
// their neighbourhood has them: drops ink at the rim, the bar and what else hides it.
void accept_by_level(Rays& rays, int n, int count) {
  const auto sector = [&](int i) { return rays.ray[i] * kSectors / count; };
  std::array<int, kSectors + 1> begin{};
  for (int i = 0; i < n; ++i) ++begin[sector(i) + 1];
  for (int b = 0; b < kSectors; ++b) begin[b + 1] += begin[b];
  std::array<float, kSectors> ball{}, ground{}, contrast{};
  const auto gather = [&](const std::vector<float>& from, int b) {
    rays.scratch.clear();
    for (int d = -1; d <= 1; ++d) {
      const int at = (b + d + kSectors) % kSectors;
      for (int i = begin[at]; i < begin[at + 1]; i += 2) rays.scratch.push_back(from[i]);
    }
  };
  for (int b = 0; b < kSectors; ++b) {
    if (begin[b] == begin[b + 1]) continue;
    gather(rays.in, b);
    ball[b] = quantile(rays.scratch, 0.8);
    gather(rays.out, b);
    ground[b] = quantile(rays.scratch, 0.5);
    contrast[b] = ball[b] - ground[b];
  }
  rays.scratch.clear();
  for (int i = 0; i < n; i += 3) {
    rays.scratch.push_back(std::abs(rays.out[i] - ground[sector(i)]));
  }
  const float scatter = 1.48f * quantile(rays.scratch, 0.5);
  rays.scratch.assign(contrast.begin(), contrast.end());
  const float usual = quantile(rays.scratch, 0.8);
  for (int i = 0; i < n; ++i) {
    const int b = sector(i);
    const float loose = 4 * scatter + 0.12f * contrast[b],
                tight = 4 * scatter + 0.02f * contrast[b];
    rays.accepted[i] = contrast[b] > 0.2f * usual && contrast[b] > 6 * scatter &&
                       std::abs(rays.in[i] - ball[b]) < loose &&
                       std::abs(rays.out[i] - ground[b]) < tight;
  }
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
    for (int pass = 0; pass < 3; ++pass) {
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
  const int k = std::clamp(static_cast<int>(u), 0, kLength - 2);
  return p[k] + (u - static_cast<float>(k)) * (p[k + 1] - p[k]);
}

// Levels shared with the accepted neighbours, then the crossing and the shape of each edge.
void find_crossings(Rays& rays, int n) {
  rays.kept.clear();
  for (int i = 0; i < n; ++i) {
    if (rays.accepted[i]) rays.kept.push_back(i);
  }
  const int kept = static_cast<int>(rays.kept.size());
  double sum_in = 0, sum_out = 0;
  int lo = 0, hi = 0;
  for (int m = 0; m < kept; ++m) {
    const int i = rays.kept[m];
    // Neighbours no farther than kSmooth rays: a level is a local matter.
    while (hi < kept && rays.kept[hi] <= i + kSmooth) {
      sum_in += rays.in[rays.kept[hi]];
      sum_out += rays.out[rays.kept[hi++]];
    }
    while (rays.kept[lo] < i - kSmooth) {
      sum_in -= rays.in[rays.kept[lo]];
      sum_out -= rays.out[rays.kept[lo++]];
    }
    const float in = static_cast<float>(sum_in / (hi - lo));
    const float out = static_cast<float>(sum_out / (hi - lo));
    const float* p = rays.profile.data() + static_cast<std::size_t>(i) * kLength;
    float at = 0;
    if (!cross(p, 0.5f * (in + out), at)) {
      rays.accepted[i] = 0;
      continue;
    }
    const float scale = 1 / (in - out);
    rays.crossing[i] = at;
    rays.near_in[i] = (profile_at(p, at - 1) - out) * scale;
    rays.near_out[i] = (profile_at(p, at + 1) - out) * scale;
  }
}

// Drops the edges whose level a step inside or outside is not what most edges have there: part of
// a speckle or of an obstacle reaches into them.
void accept_by_shape(Rays& rays, int n) {
  for (auto* shape : {&rays.near_in, &rays.near_out}) {
    rays.scratch.clear();
    for (int i : rays.kept) {
      if (rays.accepted[i]) rays.scratch.push_back((*shape)[i]);
    }
    if (rays.scratch.empty()) return;
    const float middle = quantile(rays.scratch, 0.5);
    for (float& v : rays.scratch) v = std::abs(v - middle);
    const float limit = 3.5f * 1.48f * quantile(rays.scratch, 0.5) + 0.01f;
    for (int i = 0; i < n; ++i) {
      if (rays.accepted[i] && std::abs((*shape)[i] - middle) > limit) rays.accepted[i] = 0;
    }
  }
}

// Width of the edge as a Gaussian's σ: the level falls by Φ(1/σ) − Φ(−1/σ) over two steps.
double edge_sigma(Rays& rays, double step) {
  rays.scratch.clear();
  for (int i : rays.kept) {
    if (rays.accepted[i]) rays.scratch.push_back(rays.near_in[i] - rays.near_out[i]);
  }
  if (rays.scratch.empty()) return 0;
  const double fall = std::clamp(static_cast<double>(quantile(rays.scratch, 0.5)), 0.3, 0.999);
  double sigma = 1;
  for (int pass = 0; pass < 30; ++pass) {  // bisection by steps: erf is monotonic
    const double now = std::erf(1 / (sigma * std::sqrt(2.0)));
    sigma *= 1 + 0.5 * (now - fall) / std::max(fall, 0.3);
  }
  return sigma * step;
}

}  // namespace

void trace_rim(const Frame& frame, const Rim& rim, bool bright, double blur_px, int count,
               RimTrace& trace) {
  thread_local Rays rays;  // memory only
  const float step = static_cast<float>(std::clamp(blur_px / kSharpest_px, 1.0, rim.r / 8));
  const float sign = bright ? 1.0f : -1.0f;
  const int n = frame.type == PixelType::u8 ? cast(frame.u8.view(), rim, sign, step, count, rays)
                                            : cast(frame.u16.view(), rim, sign, step, count, rays);
  trace.points.clear();
  trace.rays_in_view = n;
  trace.edge_sigma_px = 0;
  if (n < 16) return;
  accept_by_level(rays, n, count);
  find_crossings(rays, n);
  accept_by_shape(rays, n);
  trace.edge_sigma_px = edge_sigma(rays, step);
  for (int i : rays.kept) {
    if (!rays.accepted[i]) continue;
    trace.points.push_back(
        {rays.cos[i], rays.sin[i], step * rays.crossing[i], rays.ray[i] * kRimSectors / count});
  }
}

}  // namespace impactdic
