#include "sim/speckle/render.h"

#include <impactdic/error.h>
#include <impactdic/units.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "sim/speckle/noise.h"

namespace impactdic::sim::speckle {
namespace {

constexpr int kRowsPerBand = 16;

struct Vec {
  double x, y;
};

// Direction on the screen (y down) of an angle counter-clockwise from image-right.
Vec direction(double angle_deg) {
  return {std::cos(angle_deg * kRadPerDeg), -std::sin(angle_deg * kRadPerDeg)};
}

// Samples a side of a pixel that resolve the product of several edges of this blur.
int samples_per_pixel(double sigma_px) { return sigma_px >= 0.5 ? 3 : sigma_px >= 0.4 ? 4 : 5; }
constexpr int kExtraTaps = 6;  // of the pixel rule beyond the pixel's own samples

// Gauss–Hermite rule for a normal deviate of standard deviation 1.
struct NormalNode {
  double at, weight;
};
constexpr std::array<NormalNode, 3> kNormal3{
    {{-1.7320508075688772, 1.0 / 6}, {0, 2.0 / 3}, {1.7320508075688772, 1.0 / 6}}};
constexpr std::array<NormalNode, 5> kNormal5{{{-2.8569700138728056, 0.011257411327720688},
                                              {-1.3556261799742659, 0.2220759220056126},
                                              {0, 8.0 / 15},
                                              {1.3556261799742659, 0.2220759220056126},
                                              {2.8569700138728056, 0.011257411327720688}}};

BallPose between(const BallPose& a, const BallPose& b, double t) {
  const auto mix = [t](double from, double to) { return from + t * (to - from); };
  return {mix(a.cx_px, b.cx_px), mix(a.cy_px, b.cy_px), mix(a.angle_deg, b.angle_deg),
          mix(a.compression, b.compression), mix(a.compression_axis_deg, b.compression_axis_deg)};
}

// How far a point of the ball moves between two poses, at most (px).
double travel_px(const BallPose& a, const BallPose& b, double radius_px) {
  return std::hypot(b.cx_px - a.cx_px, b.cy_px - a.cy_px) +
         radius_px * (std::abs(b.angle_deg - a.angle_deg) * kRadPerDeg +
                      std::abs(b.compression - a.compression) +
                      a.compression * kRadPerDeg *
                          std::abs(b.compression_axis_deg - a.compression_axis_deg));
}

struct Span {
  double first, last;
  bool empty() const { return !(first < last); }
};
Span meet(Span a, Span b) { return {std::max(a.first, b.first), std::min(a.last, b.last)}; }

// Where |offset + slope x| <= half.
Span strip(double offset, double slope, double half) {
  if (slope == 0) return std::abs(offset) <= half ? Span{-1e30, 1e30} : Span{1, 0};
  const double a = (-half - offset) / slope, b = (half - offset) / slope;
  return {std::min(a, b), std::max(a, b)};
}

}  // namespace

// The compressed ball's own (unturned) axes: u = A⁻¹ (x − centre), A⁻¹ = (m00 m01; m01 m11).
// Squared length there: kxx dx² + 2 kxy dx dy + kyy dy².
struct BallRenderer::Placed {
  double cx, cy, weight;
  double m00, m01, m11;
  double kxx, kxy, kyy;
  std::vector<Vec> discs;  // centres on the screen
  struct Line {
    Vec centre, along;  // on the screen; direction in the unturned axes
  };
  std::vector<Line> lines;
  double shade0, shade_x, shade_y;  // light = shade0 + shade_x · x + shade_y · y

  // Columns of a row `dy` below a centre that lie within `radius` of it, as offsets from it.
  Span chord(double dy, double radius) const {
    const double root = kxy * kxy * dy * dy - kxx * (kyy * dy * dy - radius * radius);
    if (!(root > 0)) return {1, 0};
    const double half = std::sqrt(root) / kxx, middle = -kxy * dy / kxx;
    return {middle - half, middle + half};
  }
  double distance(double dx, double dy) const {
    return std::sqrt(std::max(0.0, (kxx * dx + 2 * kxy * dy) * dx + kyy * dy * dy));
  }
};

// Samples of pixel rows first … last − 1 and columns left … right − 1, with those that the pixel
// rule takes from beyond. Sample g of the picture lies at (g + 1/2) / per_pixel − 1/2.
struct BallRenderer::Band {
  int first, last, left, right, per_pixel;
  std::vector<double> y, x;  // sample positions, px
  std::vector<float> clear;  // ∏(1 − S_i), (samples in y, samples in x)

  Band(int first_row, int last_row, int first_column, int last_column, int samples_a_side)
      : first(first_row),
        last(last_row),
        left(first_column),
        right(last_column),
        per_pixel(samples_a_side) {
    const auto positions = [&](int from, int to) {
      std::vector<double> at;
      for (int g = from * per_pixel - kExtraTaps / 2; g < to * per_pixel + kExtraTaps / 2; ++g) {
        at.push_back((g + 0.5) / per_pixel - 0.5);
      }
      return at;
    };
    y = positions(first, last);
    x = positions(left, right);
    clear.assign(x.size() * y.size(), 1.0F);
  }
  float* row(std::size_t index) { return clear.data() + index * x.size(); }
  const float* row(std::size_t index) const { return clear.data() + index * x.size(); }
  // Indices [begin, end) of the samples whose column lies in [from, to], px.
  std::pair<int, int> samples(double from, double to) const {
    const auto index = [&](double at) {
      return std::clamp((at - x.front()) * per_pixel, -1.0, static_cast<double>(x.size()));
    };
    return {
        static_cast<int>(std::ceil(std::max(0.0, index(from)))),
        static_cast<int>(std::floor(std::min(index(to), static_cast<double>(x.size()) - 1) + 1))};
  }
};

void Scene::validate() const {
  const auto require = [](bool good, const char* what, const char* hint) {
    if (!good) throw InvalidArgument(what, "scene", hint);
  };
  require(width >= 1 && height >= 1 && width <= 32768 && height <= 32768,
          "the picture's size is impossible", "1 … 32768 px a side");
  require(psf_sigma_px >= 0.3 && psf_sigma_px <= 50, "the lens blur is out of range",
          "a standard deviation of 0.3 … 50 px");
  require(noise_sigma >= 0 && noise_sigma <= 255, "the noise is out of range",
          "a standard deviation of 0 … 255 grey levels");
  require(shading >= 0 && shading <= 1, "the shading is out of range", "0 … 1");
  require(bits >= 8 && bits <= 16, "the bit depth is out of range", "8 … 16 bits");
  for (const double level : {white, ink, background, bar ? bar->level : 0.0}) {
    require(level >= 0 && level <= 255, "a grey level is out of range", "0 … 255");
  }
}

OccludingBar bar_hiding(double fraction, const BallPose& pose, double radius_px, double angle_deg) {
  if (!(fraction >= 0 && fraction <= 1)) {
    throw InvalidArgument("the hidden share of the ball is out of range", "occlude", "0 … 1");
  }
  // A segment below the chord at height h (of the radius, downward) has the share
  // (acos h − h √(1 − h²)) / π, which falls with h.
  double low = -1, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double h = (low + high) / 2;
    const double share = (std::acos(h) - h * std::sqrt(1 - h * h)) / kPi;
    (share > fraction ? low : high) = h;
  }
  OccludingBar bar;
  bar.width_px = 2.5 * radius_px;
  bar.angle_deg = angle_deg;
  const Vec down = direction(angle_deg - 90);
  const double away = radius_px * (low + high) / 2 + bar.width_px / 2;
  bar.x_px = pose.cx_px + away * down.x;
  bar.y_px = pose.cy_px + away * down.y;
  return bar;
}

BallRenderer::BallRenderer(SpeckleBall ball, const Scene& scene)
    : ball_(std::move(ball)),
      scene_((scene.validate(), scene)),
      outline_(ball_.radius_px, scene.psf_sigma_px),
      per_pixel_(samples_per_pixel(scene.psf_sigma_px)),
      pixel_(shared_samples(per_pixel_, per_pixel_ + kExtraTaps)) {
  inks_.reserve(ball_.discs.size());
  for (const InkDisc& disc : ball_.discs) inks_.emplace_back(disc.radius_px, scene.psf_sigma_px);
  backdrop_ = make_backdrop();
}

double BallRenderer::bar_coverage(double x_px, double y_px) const {
  if (!scene_.bar) return 0;
  const OccludingBar& bar = *scene_.bar;
  const Vec along = direction(bar.angle_deg);
  const double off = std::abs((y_px - bar.y_px) * along.x - (x_px - bar.x_px) * along.y);
  const double half = bar.width_px / 2, reach = kEdgeReach * scene_.psf_sigma_px;
  if (off > half + reach) return 0;
  if (off < half - reach) return 1;
  return blurred_edge(half - off, scene_.psf_sigma_px) -
         blurred_edge(-half - off, scene_.psf_sigma_px);
}

Image<double> BallRenderer::make_backdrop() const {
  Image<double> out(scene_.width, scene_.height, scene_.background);
  if (!scene_.bar) return out;
  for (int y = 0; y < out.height(); ++y) {
    for (int x = 0; x < out.width(); ++x) {
      double covered = 0;
      for (std::size_t j = 0; j < pixel_.node.size(); ++j) {
        for (std::size_t i = 0; i < pixel_.node.size(); ++i) {
          covered += pixel_.weight[j] * pixel_.weight[i] *
                     bar_coverage(x + pixel_.node[i], y + pixel_.node[j]);
        }
      }
      out(x, y) += covered * (scene_.bar->level - scene_.background);
    }
  }
  return out;
}

BallRenderer::Placed BallRenderer::place(const BallPose& pose, double shift_px,
                                         double weight) const {
  const double c = pose.compression;
  if (!(c >= 0 && c <= 0.5)) {
    throw InvalidArgument("the compression is out of range", "pose", "0 … 0.5 of the diameter");
  }
  const Vec axis = direction(pose.compression_axis_deg), turn = direction(pose.angle_deg);
  Placed p;
  p.cx = pose.cx_px + shift_px * axis.x;
  p.cy = pose.cy_px + shift_px * axis.y;
  p.weight = weight;
  const double grow = c / (1 - c);  // A = I − c n nᵀ, A⁻¹ = I + c/(1 − c) n nᵀ
  p.m00 = 1 + grow * axis.x * axis.x;
  p.m01 = grow * axis.x * axis.y;
  p.m11 = 1 + grow * axis.y * axis.y;
  p.kxx = p.m00 * p.m00 + p.m01 * p.m01;
  p.kxy = p.m01 * (p.m00 + p.m11);
  p.kyy = p.m01 * p.m01 + p.m11 * p.m11;
  // Counter-clockwise on the screen with y down: (x, y) -> (x cos + y sin, −x sin + y cos).
  const auto on_screen = [&](double x, double y) -> Vec {
    const Vec turned{x * turn.x - y * turn.y, x * turn.y + y * turn.x};
    const double squeeze = c * (turned.x * axis.x + turned.y * axis.y);
    return {p.cx + turned.x - squeeze * axis.x, p.cy + turned.y - squeeze * axis.y};
  };
  p.discs.reserve(ball_.discs.size());
  for (const InkDisc& disc : ball_.discs) p.discs.push_back(on_screen(disc.x_px, disc.y_px));
  for (const InkLine& line : ball_.lines) {
    p.lines.push_back(
        {on_screen(line.x_px, line.y_px), direction(line.angle_deg + pose.angle_deg)});
  }
  const Vec lamp = direction(scene_.lamp_deg);
  const double fall = scene_.shading / 2 / ball_.radius_px;
  p.shade_x = fall * lamp.x;
  p.shade_y = fall * lamp.y;
  p.shade0 = 1 - scene_.shading / 2 - p.shade_x * p.cx - p.shade_y * p.cy;
  return p;
}

std::vector<BallRenderer::Placed> BallRenderer::instants(const ShutterPath& path) const {
  std::vector<std::pair<BallPose, double>> poses;
  const auto expose = [&](const BallPose& from, const BallPose& to, double share) {
    const double travel = travel_px(from, to, ball_.radius_px);
    if (travel == 0) {
      poses.emplace_back(from, share);
      return;
    }
    const Quadrature time = gauss_legendre(2 + static_cast<int>(std::ceil(1.2 * travel)));
    for (std::size_t i = 0; i < time.node.size(); ++i) {
      poses.emplace_back(between(from, to, time.node[i] + 0.5), share * time.weight[i]);
    }
  };
  const double before = travel_px(path.open, path.middle, ball_.radius_px);
  const double after = travel_px(path.middle, path.close, ball_.radius_px);
  if (before == 0 && after == 0) {
    poses.emplace_back(path.middle, 1.0);
  } else {
    expose(path.open, path.middle, 0.5);
    expose(path.middle, path.close, 0.5);
  }
  std::vector<Placed> out;
  for (const auto& [pose, weight] : poses) {
    // The ball's blur is squeezed with it to σ (1 − c) along the axis; the lens has σ there.
    const double lost =
        scene_.psf_sigma_px * std::sqrt(std::max(0.0, pose.compression * (2 - pose.compression)));
    if (lost == 0) {
      out.push_back(place(pose, 0, weight));
    } else if (lost < 0.15) {
      for (const auto& n : kNormal3) out.push_back(place(pose, lost * n.at, weight * n.weight));
    } else {
      for (const auto& n : kNormal5) out.push_back(place(pose, lost * n.at, weight * n.weight));
    }
  }
  return out;
}

void BallRenderer::paint_discs(const Placed& placed, Band& band) const {
  for (std::size_t i = 0; i < inks_.size(); ++i) {
    const BlurredDisc& ink = inks_[i];
    const Vec centre = placed.discs[i];
    const double reach = ink.reach_px(), core = ink.core_px();
    if (centre.y + reach < band.y.front() || centre.y - reach > band.y.back()) continue;
    for (std::size_t j = 0; j < band.y.size(); ++j) {
      const double dy = band.y[j] - centre.y;
      const Span chord = placed.chord(dy, reach);
      if (chord.empty()) continue;
      float* clear = band.row(j);
      const auto [begin, end] = band.samples(centre.x + chord.first, centre.x + chord.last);
      int full_begin = end, full_end = end;  // samples that the ink covers entirely
      if (const Span full = placed.chord(dy, core); core > 0 && !full.empty()) {
        const auto inner = band.samples(centre.x + full.first, centre.x + full.last);
        if (inner.first < inner.second) std::tie(full_begin, full_end) = inner;
      }
      const auto paint = [&](int from, int to) {
        for (int s = from; s < to; ++s) {
          clear[s] *=
              1.0F - ink(placed.distance(band.x[static_cast<std::size_t>(s)] - centre.x, dy));
        }
      };
      paint(begin, full_begin);
      std::fill(clear + full_begin, clear + full_end, 0.0F);
      paint(full_end, end);
    }
  }
}

void BallRenderer::paint_lines(const Placed& placed, Band& band) const {
  const double sigma = scene_.psf_sigma_px, reach = kEdgeReach * sigma;
  for (std::size_t i = 0; i < ball_.lines.size(); ++i) {
    const auto& [centre, along] = placed.lines[i];
    const double half_length = ball_.lines[i].length_px / 2,
                 half_width = ball_.lines[i].width_px / 2;
    // Along and across the line as linear functions of the column.
    const double along_x = along.x * placed.m00 + along.y * placed.m01;
    const double along_y = along.x * placed.m01 + along.y * placed.m11;
    const double across_x = along.x * placed.m01 - along.y * placed.m00;
    const double across_y = along.x * placed.m11 - along.y * placed.m01;
    for (std::size_t j = 0; j < band.y.size(); ++j) {
      const double dy = band.y[j] - centre.y;
      const Span near = meet(strip(along_y * dy, along_x, half_length + reach),
                             strip(across_y * dy, across_x, half_width + reach));
      if (near.empty()) continue;
      float* clear = band.row(j);
      const auto [begin, end] = band.samples(centre.x + near.first, centre.x + near.last);
      for (int s = begin; s < end; ++s) {
        const double dx = band.x[static_cast<std::size_t>(s)] - centre.x;
        const double t = along_x * dx + along_y * dy, n = across_x * dx + across_y * dy;
        clear[s] *= static_cast<float>(
            1 - (blurred_edge(half_width - n, sigma) - blurred_edge(-half_width - n, sigma)) *
                    (blurred_edge(half_length - t, sigma) - blurred_edge(-half_length - t, sigma)));
      }
    }
  }
}

void BallRenderer::sum_pixels(const Placed& placed, const Band& band, Image<double>& out) const {
  const std::size_t taps = pixel_.weight.size();
  const auto step = static_cast<std::size_t>(per_pixel_);
  const auto columns = static_cast<std::size_t>(band.right - band.left);
  const double contrast = scene_.white - scene_.ink;
  std::vector<double> seen(band.x.size());             // one row of samples, above the background
  std::vector<double> means(band.y.size() * columns);  // each row of samples, mean over columns
  for (std::size_t j = 0; j < band.y.size(); ++j) {
    const float* clear = band.row(j);
    const double y = band.y[j], dy = y - placed.cy;
    const Span near = placed.chord(dy, outline_.reach_px());
    const Span inside = placed.chord(dy, outline_.core_px());
    std::fill(seen.begin(), seen.end(), 0.0);
    const auto [begin, end] = near.empty()
                                  ? std::pair(0, 0)
                                  : band.samples(placed.cx + near.first, placed.cx + near.last);
    for (int s = begin; s < end; ++s) {
      const auto i = static_cast<std::size_t>(s);
      const double dx = band.x[i] - placed.cx;
      const double light = placed.shade0 + placed.shade_x * band.x[i] + placed.shade_y * y;
      double value = light * (scene_.ink + contrast * clear[i]) - scene_.background;
      if (!(dx > inside.first && dx < inside.last)) value *= outline_(placed.distance(dx, dy));
      if (scene_.bar) value *= 1 - bar_coverage(band.x[i], y);
      seen[i] = value;
    }
    for (std::size_t x = 0; x < columns; ++x) {
      double sum = 0;
      for (std::size_t k = 0; k < taps; ++k) sum += pixel_.weight[k] * seen[x * step + k];
      means[j * columns + x] = sum;
    }
  }
  for (int y = band.first; y < band.last; ++y) {
    double* row = out.row(y) + band.left;
    for (std::size_t k = 0; k < taps; ++k) {
      const double weight = placed.weight * pixel_.weight[k];
      const double* mean =
          means.data() + (static_cast<std::size_t>(y - band.first) * step + k) * columns;
      for (std::size_t x = 0; x < columns; ++x) row[x] += weight * mean[x];
    }
  }
}

void BallRenderer::add_rows(const Placed& placed, int first, int last, Image<double>& out) const {
  const double reach = outline_.reach_px() + pixel_.node.back();
  const auto clip = [](double at, int limit) {
    return static_cast<int>(std::clamp(at, 0.0, static_cast<double>(limit)));
  };
  first = std::max(first, clip(std::ceil(placed.cy - reach), out.height()));
  last = std::min(last, clip(std::floor(placed.cy + reach) + 1, out.height()));
  const int left = clip(std::ceil(placed.cx - reach), out.width());
  const int right = clip(std::floor(placed.cx + reach) + 1, out.width());
  if (first >= last || left >= right) return;
  Band band(first, last, left, right, per_pixel_);
  paint_discs(placed, band);
  paint_lines(placed, band);
  sum_pixels(placed, band, out);
}

Image<double> BallRenderer::exact(const BallPose& pose) const {
  return exact(ShutterPath{pose, pose, pose});
}

Image<double> BallRenderer::exact(const ShutterPath& path) const {
  Image<double> out = backdrop_;
  const std::vector<Placed> placed = instants(path);
  const int bands = (out.height() + kRowsPerBand - 1) / kRowsPerBand;
  tbb::parallel_for(0, bands, [&](int band) {
    const int first = band * kRowsPerBand, last = std::min(out.height(), first + kRowsPerBand);
    for (const Placed& one : placed) add_rows(one, first, last, out);
  });
  return out;
}

void BallRenderer::render(const BallPose& pose, std::int64_t frame_index, Frame& out) const {
  render(ShutterPath{pose, pose, pose}, frame_index, out);
}

void BallRenderer::render(const ShutterPath& path, std::int64_t frame_index, Frame& out) const {
  Image<double> grey = exact(path);
  out.reset(scene_.width, scene_.height, scene_.bits);
  const double top = out.full_scale();
  tbb::parallel_for(0, scene_.height, [&](int y) {
    double* row = grey.row(y);
    const auto width = static_cast<std::size_t>(scene_.width);
    if (scene_.noise_sigma > 0) {
      add_row_noise({row, width}, scene_.noise_sigma, scene_.noise_seed, frame_index, y);
    }
    for (int x = 0; x < scene_.width; ++x) {
      const double level = std::clamp(std::floor(row[x] * (top / 255) + 0.5), 0.0, top);
      if (out.type == PixelType::u8) {
        out.u8(x, y) = static_cast<std::uint8_t>(level);
      } else {
        out.u16(x, y) = static_cast<std::uint16_t>(level);
      }
    }
  });
}

}  // namespace impactdic::sim::speckle
