#include "host/circle/sphere/sphere_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "host/circle/rim/blurred_edge.h"
#include "host/circle/rim/rim_levels.h"
#include "host/circle/rim/rim_texture.h"
#include "host/circle/settings/rim_model.h"
#include "host/circle/settings/sphere.h"

namespace impactdic::circle {
namespace {

// Cosine to the line of sight, and distance from the axis in radii, of what a sample of a line
// sees of the sphere: means over the edge's blur.
struct Seen {
  double x, z;
};

// `depth_px` inside the rim.
Seen seen_at(double depth_px, double sigma_px, double r_px) {
  constexpr int kNodes = 48;
  const double from = std::max(0.0, depth_px - kSphere.blur_reach * sigma_px);
  const double to = std::max(depth_px, 0.0) + kSphere.blur_reach * sigma_px;
  double sum = 0, x_sum = 0, z_sum = 0;
  for (int i = 0; i < kNodes; ++i) {
    const double d = std::lerp(from, to, (i + 0.5) / kNodes), off = (d - depth_px) / sigma_px;
    const double weight = std::exp(-0.5 * off * off), x = std::max(0.0, 1 - d / r_px);
    sum += weight;
    x_sum += weight * x;
    z_sum += weight * std::sqrt(1 - x * x);
  }
  return {x_sum / sum, z_sum / sum};
}

std::array<Seen, kSamples> seen_along(const LineRequest& request, double r_px) {
  std::array<Seen, kSamples> seen;
  for (int k = 0; k < kSamples; ++k) {
    seen[k] = seen_at((kInside - k) * request.step_px, request.edge_sigma_px, r_px);
  }
  return seen;
}

// The same for all samples of a line at once; the eighth place repeats the last.
class SeenLanes {
 public:
  explicit SeenLanes(const std::array<Seen, kSamples>& seen) {
    static_assert(kSamples < kLanes && kLanes == 8);
    for (int k = 0; k < kLanes; ++k) {
      x_[k / 4][k % 4] = seen[std::min(k, kSamples - 1)].x;
      z_[k / 4][k % 4] = seen[std::min(k, kSamples - 1)].z;
    }
  }
  // The light's level in the direction (c, s).
  void light(const LightTerms& terms, double c, double s, Lanes& level) const {
    for (int half = 0; half < 2; ++half) {
      FourPlaces here;
      light_of(terms, FourPlaces(x_[half] * c), FourPlaces(x_[half] * s), z_[half], here);
      for (int k = 0; k < 4; ++k) level[4 * half + k] = static_cast<float>(here[k]);
    }
  }

 private:
  FourPlaces x_[2], z_[2];
};

// Light dims paint and ink alike, but not the background: with less light ink falls farther below
// the background, in shares of the contrast. What is missing to bare paint is told as it would be
// in the usual contrast, by this factor.
float as_usual(float contrast, float ground, const LineTrace::Levels& levels) {
  if (ground <= 0) return 1;  // a ball darker than the background
  const float usual = (levels.usual + ground) / levels.usual;
  return std::min(usual * contrast / (contrast + ground), 1.0f);
}

// What a line's grey levels are told in by an outline. Ink and paint are shares of the light, but
// noise is not: the root of the light is between the two.
float outline_scale(const LineTrace::Levels& levels, float c, float s, float ground) {
  const auto x = static_cast<double>(c), y = static_cast<double>(s);
  const double paint = levels.sphere.at(x, y, kSphere.rim_z);
  const double most = static_cast<double>(std::max(levels.usual + ground, levels.usual));
  return levels.usual * static_cast<float>(std::sqrt(std::max(paint / most, kSphere.least_light)));
}

// Mean of what the kept lines show innermost, sector by sector, and its variance.
struct Inside {
  double mean = 0, variance = 0;
};
std::optional<Inside> inside_of(const RimLines& lines) {
  std::array<double, kRimSectors> sum{}, count{};
  for (std::size_t i = 0; i < lines.size(); ++i) {
    sum[lines.sector[i]] += static_cast<double>(lines.profile[i].v[0]);
    ++count[lines.sector[i]];
  }
  double all = 0, squares = 0, sectors = 0;
  for (int b = 0; b < kRimSectors; ++b) {
    if (count[b] == 0) continue;
    const double mean = sum[b] / count[b];
    all += mean;
    squares += mean * mean;
    ++sectors;
  }
  if (sectors < 2) return std::nullopt;
  const double mean = all / sectors;
  return Inside{mean, (squares / sectors - mean * mean) / (sectors - 1)};
}

// The light's contrast at the centre over that at the rim.
double darkening(const LineTrace::Levels& levels) {
  const double ground = quantile(levels.ground, 0.5);
  const auto at_rim = levels_at_rim(levels.sphere);
  const double rim = std::accumulate(at_rim.begin(), at_rim.end(), 0.0) / kLevelSectors;
  return (levels.sphere.at(0, 0, 1) - ground) / std::max(rim - ground, 1e-6);
}

// How the surface's length goes into the samples of a line, from the rim on inwards.
struct Foreshortening {
  int length = 0;       // samples of a strip
  double step_rad = 0;  // between them
  std::vector<std::array<double, kTexture>> weight;

  Foreshortening(const LineRequest& request, double r_px) {
    const double sigma = request.edge_sigma_px;
    const double deepest = kInside * request.step_px + kSphere.blur_reach * sigma;
    const double end = std::acos(std::max(1 - deepest / r_px, 0.0));
    step_rad = kSphere.strip_px / r_px;
    length = static_cast<int>(end / step_rad) + 1;
    weight.resize(static_cast<std::size_t>(length));
    std::array<double, kTexture> sum{};
    for (int i = 0; i < length; ++i) {
      const double angle = (i + 0.5) * step_rad, depth = r_px * (1 - std::cos(angle));
      for (int k = 0; k < kTexture; ++k) {
        const double off = (depth - (kInside - k) * request.step_px) / sigma;
        const double w = std::exp(-0.5 * off * off) * std::sin(angle);
        weight[i][k] = w;
        sum[k] += w;
      }
    }
    for (auto& w : weight) {
      for (int k = 0; k < kTexture; ++k) w[k] /= sum[k];
    }
  }
};

// Where the samples of the strips lie: the same for every line.
struct StripPlaces {
  struct Place {
    double sin, cos;  // of the surface's normal against the line of sight
  };
  std::vector<Place> all;  // strip by strip
  int length;

  StripPlaces(const Foreshortening& shape, double last) : length(shape.length) {
    const double span = shape.length * shape.step_rad;
    for (int strip = 0; strip < kSphere.strips; ++strip) {
      const double begin = (last - span) * strip / (kSphere.strips - 1.0);
      for (int m = 0; m < length; ++m) {
        const double angle = begin + (length - 1 - m) * shape.step_rad;
        all.push_back({std::sin(angle), std::cos(angle)});
      }
    }
  }
  const Place& at(int strip, int m) const {
    return all[static_cast<std::size_t>(strip * length + m)];
  }
};

template <typename T>
void add_strips(ImageView<const T> picture, const Rim& rim, const LineRequest& request,
                const LineTrace& trace) {
  const Sampler<T> sampler(picture);
  const float sign = sign_of(request.polarity);
  const Foreshortening shape(request, rim.r);
  const double last = std::asin(kSphere.most_strip), span = shape.length * shape.step_rad;
  if (span > last) return;
  const StripPlaces places(shape, last);
  const RimLines& lines = trace.lines;
  const double ground = quantile(trace.levels.ground, 0.5);
  const bool outline = request.surface == Surface::kOutline;
  const std::array<Seen, kSamples> seen = seen_along(request, rim.r);
  for (std::size_t i = 0; i < lines.size(); i += kSphere.strips_every) {
    const double c = lines.cos[i], s = lines.sin[i];
    const auto scale = static_cast<double>(
        outline_scale(trace.levels, lines.cos[i], lines.sin[i], static_cast<float>(ground)));
    for (int strip = 0; strip < kSphere.strips; ++strip) {
      double b[kTexture] = {};
      bool inside = true;
      for (int m = 0; m < shape.length && inside; ++m) {
        const auto [x, z] = places.at(strip, m);
        const auto px = static_cast<float>(rim.cx + rim.r * x * c);
        const auto py = static_cast<float>(rim.cy + rim.r * x * s);
        inside = sampler.inside(px, py, kSphere.margin_px);
        if (!inside) break;
        const double paint = trace.levels.sphere.at(x * c, x * s, z) - ground;
        const double level = static_cast<double>(sign * sampler.bilinear(px, py)) - ground;
        inside = paint > kSphere.least_contrast * static_cast<double>(trace.levels.usual);
        if (outline) {
          // As it would be lit at the rim.
          const double share = (level + ground) / (paint + ground);
          for (int k = 0; k < kTexture; ++k) b[k] += shape.weight[m][k] * share;
          continue;
        }
        const double ink = (1 - level / paint) * as_usual(static_cast<float>(paint),
                                                          static_cast<float>(ground), trace.levels);
        for (int k = 0; k < kTexture; ++k) b[k] += shape.weight[m][k] * (1 - ink);
      }
      if (!inside) continue;
      for (int k = 0; outline && k < kTexture; ++k) {
        const double paint = trace.levels.sphere.at(seen[k].x * c, seen[k].x * s, seen[k].z);
        b[k] = (b[k] * paint - ground) / scale;
      }
      float samples[kTexture];
      for (int k = 0; k < kTexture; ++k) samples[k] = static_cast<float>(b[k]);
      request.texture->add(samples, static_cast<float>(trace.noise));
    }
  }
}

}  // namespace

void keep_clear_sphere_lines(const CastLines& lines, const std::vector<float>& grounds,
                             const Rim& rim, const LineRequest& request, LineTrace& trace) {
  const LineTrace::Levels& levels = trace.levels;
  const std::array<Seen, kSamples> seen = seen_along(request, rim.r);
  const SampleVector ball = blurred_edge(0, request.edge_sigma_px / request.step_px,
                                         kRimModel.kernel_px / request.step_px)
                                .level;
  const SeenLanes places(seen);
  Lanes whole{};  // the profile of bare paint
  for (int k = 0; k < kSamples; ++k) whole[k] = static_cast<float>(ball[k]);
  RimLines& out = trace.lines;
  const int n = lines.size();
  out.make_room(static_cast<std::size_t>(n));
  constexpr int kBeside = kClear.beside;
  thread_local std::vector<int> kept;  // number of each line kept; memory only
  kept.resize(static_cast<std::size_t>(n));
  int count = 0, blocked = -kBeside - 1;  // the last line with something else outside
  for (int i = 0; i < n; ++i) {
    const Profile& level = lines.level[i].v;
    const float ground = grounds[i];
    Lanes paint;
    places.light(levels.sphere.terms(), lines.cos[i], lines.sin[i], paint);
    paint -= ground;
    const float contrast = paint[kInside];
    if (contrast < kSphere.least_contrast * levels.usual) continue;
    if (!is_clear(contrast, levels.usual, level[kSamples - 1], ground, levels.noise)) {
      blocked = i;
      while (count > 0 && kept[count - 1] >= i - kBeside) --count;
      continue;
    }
    if (i - blocked <= kBeside) continue;
    // Ink, or an obstacle across the rim.
    const float inside = std::max({level[0], level[1], level[2]}) - ground;
    if (inside < std::max(kClear.nothing * contrast, kClear.nothing_noise * levels.noise)) continue;
    const float relative = contrast / levels.usual;
    const Lanes least = Lanes{} + 0.5f * contrast;
    const Lanes scale = paint < least ? least : paint;
    Lanes less = Lanes{} + 1;
    if (ground > 0) {
      const float usual = (levels.usual + ground) / levels.usual;
      const Lanes share = usual * scale / (scale + ground);
      less = less < share ? less : share;
    }
    out.profile[count].v = whole - (whole - (level - ground) / scale) * less;
    out.profile[count].v[kSamples] = 0;
    float log_scale = 0;
    for (int k = 0; request.texture && k < kSamples; ++k) log_scale += std::log(scale[k] / less[k]);
    out.cos[count] = lines.cos[i];
    out.sin[count] = lines.sin[i];
    out.weight[count] = relative * relative;
    out.sector[count] = lines.sector(i, kRimSectors);
    out.log_scale[count] = log_scale;
    kept[count++] = i;
  }
  out.keep(static_cast<std::size_t>(count));
}

void keep_outline_lines(const CastLines& lines, const std::vector<float>& grounds,
                        LineTrace& trace) {
  const LineTrace::Levels& levels = trace.levels;
  RimLines& out = trace.lines;
  const int n = lines.size();
  out.make_room(static_cast<std::size_t>(n));
  constexpr int kBeside = kClear.beside;
  thread_local std::vector<int> kept;  // number of each line kept; memory only
  kept.resize(static_cast<std::size_t>(n));
  int count = 0, blocked = -kBeside - 1;  // the last line with something else outside
  const float beyond = kClear.ground_noise * levels.noise + kClear.ground_tolerance * levels.usual;
  float noise_sq = 0;
  const float something = kClear.nothing_noise * levels.noise;
  for (int i = 0; i < n; ++i) {
    const Profile& level = lines.level[i].v;
    const float ground = grounds[i];
    if (std::abs(level[kSamples - 1] - ground) > beyond) {
      blocked = i;
      while (count > 0 && kept[count - 1] >= i - kBeside) --count;
      continue;
    }
    if (i - blocked <= kBeside) continue;
    const float most = std::max({level[0], level[1], level[2]}) - ground;
    const float least = std::min({level[0], level[1], level[2]}) - ground;
    if (std::max(most, -least) < something) continue;
    const float scale = outline_scale(levels, lines.cos[i], lines.sin[i], ground);
    for (int k = 0; k < kSamples; ++k) out.profile[count].v[k] = (level[k] - ground) / scale;
    const float relative = levels.usual / scale;
    noise_sq += relative * relative;
    out.profile[count].v[kSamples] = 0;
    out.cos[count] = lines.cos[i];
    out.sin[count] = lines.sin[i];
    out.weight[count] = 1;
    out.sector[count] = lines.sector(i, kRimSectors);
    out.log_scale[count] = static_cast<float>(kSamples) * std::log(scale);
    kept[count++] = i;
  }
  out.keep(static_cast<std::size_t>(count));
  if (count > 0) trace.noise *= std::sqrt(static_cast<double>(noise_sq) / count);
}

bool is_evenly_lit(const LineTrace& trace) {
  constexpr std::size_t kEvery = 8;
  const RimLines& lines = trace.lines;
  double least = 1e300, most = -1e300;
  for (std::size_t i = 0; i < lines.size(); i += kEvery) {
    const auto sector = static_cast<std::size_t>(lines.sector[i] * kLevelSectors / kRimSectors);
    const double level = trace.levels.sphere.at(static_cast<double>(lines.cos[i]),
                                                static_cast<double>(lines.sin[i]), kSphere.rim_z);
    const double contrast = level - static_cast<double>(trace.levels.ground[sector]);
    least = std::min(least, contrast);
    most = std::max(most, contrast);
  }
  return least > kSphere.even * most;
}

bool is_plainly_lit(const LineTrace& trace) {
  return is_evenly_lit(trace) && darkening(trace.levels) < kSphere.darker_limb;
}

double paint_beside_rim(const LineTrace& trace, const TextureSums& texture) {
  const double told = texture.shown_inside();
  const std::optional<Inside> shown = inside_of(trace.lines);
  if (!shown || !(told > 0)) return 1;
  const double brighter = shown->mean / told - 1;
  const double chance = std::pow(kSphere.paint_chance / told, 2) * shown->variance;
  const double beyond = 1 - chance / std::max(brighter * brighter, 1e-12);
  if (beyond < 0) return 1;
  const double hidden = (kSphere.paint_seen - texture.bare_share()) / kSphere.paint_seen_over;
  const double by = 1 + std::clamp(hidden, 0.0, 1.0) * beyond * brighter;
  const double darker = darkening(trace.levels);
  return std::clamp(by, std::min(1.0, darker), std::max(1.0, darker));
}

void add_sphere_texture(const Frame& frame, const Rim& rim, const LineRequest& request,
                        const LineTrace& trace) {
  // A fit that ran away has no surface, and its lines will say so.
  constexpr double kLargest_px = 1e6;
  if (!(rim.r > 0 && rim.r < kLargest_px && request.edge_sigma_px < kLargest_px)) return;
  if (frame.type == PixelType::kU8) {
    add_strips(frame.u8.view(), rim, request, trace);
  } else {
    add_strips(frame.u16.view(), rim, request, trace);
  }
}

}  // namespace impactdic::circle
