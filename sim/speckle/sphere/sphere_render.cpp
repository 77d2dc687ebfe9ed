#include "sim/speckle/sphere/sphere_render.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "host/base/parallel/parallel_for.h"
#include "sim/speckle/motion.h"

namespace impactdic::sim::speckle {
namespace {

constexpr int kRowsPerPixel = 32;  // of lines
constexpr double kEndRows = 1;     // px from the ball's upper and lower end
constexpr int kEndLines = 8;       // in a row there
constexpr int kPixelsPerBlock = 4, kPixelsPerBand = 64;
constexpr double kReach = 5;  // of the lens, in standard deviations: 6e-7 of a full edge

// Cells in a pixel's width: few enough that lens and pixel see none of their raster.
int cells_for(double sigma_px) { return sigma_px >= 0.5 ? 4 : sigma_px >= 0.4 ? 5 : 7; }

// Mean over the pixel of the Gaussian about a point `away` from its centre.
double lens_and_pixel(double away, double sigma) {
  return blurred_edge(away + 0.5, sigma) - blurred_edge(away - 0.5, sigma);
}

// The filter from cells to a pixel. `spread`: the variance of what lies about a cell's middle and
// is taken there.
std::vector<double> make_filter(double sigma_px, int per_pixel, int halo, double spread) {
  const double sigma = std::sqrt(sigma_px * sigma_px + spread);
  std::vector<double> weights;
  double sum = 0;
  for (int k = 0; k < (2 * halo + 1) * per_pixel; ++k) {
    const double away = (k + 0.5) / per_pixel - halo - 0.5;
    weights.push_back(lens_and_pixel(away, sigma));
    sum += weights.back();
  }
  for (double& w : weights) w /= sum;
  return weights;
}

// The parts of `span` that none of `joined` covers, which ascends.
template <typename Visit>
void each_gap(const Span& span, const std::vector<Span>& joined, const Visit& visit) {
  auto next = std::lower_bound(joined.begin(), joined.end(), span.first,
                               [](const Span& a, double x) { return a.last < x; });
  double from = span.first;
  for (; next != joined.end() && next->first < span.last; ++next) {
    visit(Span{from, next->first});
    from = next->last;
  }
  visit(Span{from, span.last});
}

// What a shape covers of each cell, and the moment of that about the cell's middle, in cells.
struct Shares {
  std::vector<float> part, moment;

  explicit Shares(std::size_t count) : part(count), moment(count) {}
  // Adds the stretch [a, b), in cells, times `weight`.
  void add(double a, double b, double weight) {
    a = std::max(a, 0.0);
    b = std::min(b, static_cast<double>(part.size()));
    if (!(a < b)) return;
    const auto i = static_cast<std::size_t>(a);
    const auto j = std::min(static_cast<std::size_t>(b), part.size() - 1);
    const auto within = [&](std::size_t cell, double from, double to) {
      part[cell] += static_cast<float>(weight * (to - from));
      moment[cell] += static_cast<float>(weight * (to - from) * ((from + to) / 2 - 0.5));
    };
    const auto left = static_cast<double>(i), right = static_cast<double>(j);
    if (i == j) return within(i, a - left, b - left);
    within(i, a - left, 1);
    const auto full = static_cast<float>(weight);
    for (std::size_t k = i + 1; k < j; ++k) part[k] += full;
    within(j, 0, b - right);
  }
  void clear(std::size_t begin, std::size_t end) {
    std::fill(part.begin() + static_cast<std::ptrdiff_t>(begin),
              part.begin() + static_cast<std::ptrdiff_t>(end), 0.0F);
    std::fill(moment.begin() + static_cast<std::ptrdiff_t>(begin),
              moment.begin() + static_cast<std::ptrdiff_t>(end), 0.0F);
  }
};

}  // namespace

struct SphereRenderer::Columns {
  double start, per_pixel;  // the first cell's left edge, px
  Shares ball, ink;         // of one line
  std::vector<float> light, free;
  Shares value;               // grey levels above the background, summed over the lines of a row
  std::vector<float> phases;  // the row, first all first cells of the pixels, then all second ...

  Columns(double start_px, int cells_per_pixel, std::size_t count)
      : start(start_px),
        per_pixel(cells_per_pixel),
        ball(count),
        ink(count),
        light(count, 1.0F),
        free(count, 1.0F),
        value(count),
        phases(count) {}
  double cell(double x) const { return (x - start) * per_pixel; }
  double middle(int i) const { return start + (i + 0.5) / per_pixel; }
  void add(Shares& to, const Span& span, double weight = 1) {
    if (!span.empty()) to.add(cell(span.first), cell(span.last), weight);
  }
  // The cells that a stretch of the line lies in.
  std::pair<int, int> reach(const Span& span) const {
    const auto count = static_cast<double>(light.size());
    return {static_cast<int>(std::clamp(std::floor(cell(span.first)), 0.0, count)),
            static_cast<int>(std::clamp(std::floor(cell(span.last)) + 1, 0.0, count))};
  }
  // Takes the line's shares into the row.
  void take(const SynthScene& scene, const Span& outline) {
    const auto white = static_cast<float>(scene.white), black = static_cast<float>(scene.ink),
               behind = static_cast<float>(scene.background), contrast = white - black;
    const auto [from, to] = reach(outline);
    const auto begin = static_cast<std::size_t>(from), end = static_cast<std::size_t>(to);
    const auto add = [&](const std::vector<float>& of_ball, const std::vector<float>& of_ink,
                         std::vector<float>& out) {
      for (std::size_t i = begin; i < end; ++i) {
        out[i] += free[i] *
                  (light[i] * (white * of_ball[i] - contrast * of_ink[i]) - behind * of_ball[i]);
      }
    };
    add(ball.part, ink.part, value.part);
    add(ball.moment, ink.moment, value.moment);
    ball.clear(begin, end);
    ink.clear(begin, end);
  }
  // Filters the row along the line. A cell's moment moves its content by as much: half of it is put
  // on the next cell and taken from the one before.
  void filter(const std::vector<double>& weights, std::span<float> out) {
    const auto n = static_cast<std::size_t>(per_pixel), count = value.part.size();
    for (std::size_t phase = 0; phase < n; ++phase) {
      float* to = phases.data() + phase * (count / n);
      for (std::size_t i = phase; i < count; i += n) {
        const float before = i > 0 ? value.moment[i - 1] : 0;
        const float after = i + 1 < count ? value.moment[i + 1] : 0;
        *to++ = value.part[i] + (before - after) / 2;
      }
    }
    std::fill(out.begin(), out.end(), 0.0F);
    for (std::size_t k = 0; k < weights.size(); ++k) {
      const auto w = static_cast<float>(weights[k]);
      const float* from = phases.data() + (k % n) * (count / n) + k / n;
      for (std::size_t x = 0; x < out.size(); ++x) out[x] += w * from[x];
    }
    value.clear(0, count);
  }
};

SphereRenderer::SphereRenderer(SpeckleSphere sphere, const SynthScene& scene)
    : sphere_(std::move(sphere)),
      scene_((scene.validate(), scene)),
      lit_(scene.lamp_share > 0 || scene.limb_darkening > 0 || scene.shading > 0),
      cells_per_pixel_(cells_for(scene.psf_sigma_px)),
      halo_(static_cast<int>(std::ceil(kReach * scene.psf_sigma_px))) {
  const double up = scene.lamp_elevation_deg * kRadPerDeg;
  const Vec aside = direction(scene.lamp_deg);
  aside_ = {aside.x, -aside.y};
  lamp_ = {std::cos(up) * aside.x, -std::cos(up) * aside.y, std::sin(up)};
  across_ = make_filter(scene.psf_sigma_px, cells_per_pixel_, halo_,
                        1.0 / (cells_per_pixel_ * cells_per_pixel_) / 12);
  down_ = make_filter(scene.psf_sigma_px, kRowsPerPixel, halo_, 0);
  const int samples = samples_per_pixel(scene.psf_sigma_px);
  backdrop_ = make_backdrop(scene_, shared_samples(samples, samples + kExtraTaps));
}

SphereRenderer::Box SphereRenderer::box_of(const SphereView& view) const {
  const auto clip = [](double at, int limit) {
    return static_cast<int>(std::clamp(at, 0.0, static_cast<double>(limit)));
  };
  const double reach = halo_ + 1;
  return {clip(std::floor(view.columns().first - reach), scene_.width),
          clip(std::ceil(view.columns().last + reach) + 1, scene_.width),
          clip(std::floor(view.rows().first - reach), scene_.height),
          clip(std::ceil(view.rows().last + reach) + 1, scene_.height)};
}

double SphereRenderer::light(const SphereView& view, const Eigen::Vector3d& point) const {
  const Eigen::Vector3d normal = point / sphere_.radius_px;
  double light = 1 - scene_.shading / 2 * (1 - normal.head<2>().dot(aside_));
  light *= 1 - scene_.lamp_share * (1 - std::max(0.0, normal.dot(lamp_)));
  if (scene_.limb_darkening > 0) {
    light *= 1 - scene_.limb_darkening * (1 - normal.dot(view.to_camera(point)));
  }
  return light;
}

// Light at the middle of each cell. At the outline it changes as the root of the distance; there
// its mean over the part of the cell that the ball covers.
void SphereRenderer::light_line(const SphereView& view, const SphereLine& line,
                                Columns& cells) const {
  constexpr double kRim = 3;  // cells
  static const Quadrature rule = gauss_legendre(3);
  const double first = cells.cell(line.outline().first), last = cells.cell(line.outline().last);
  const auto at = [&](double cell) {
    return light(view, line.point(cells.start + cell / cells.per_pixel));
  };
  const auto [begin, end] = cells.reach(line.outline());
  for (int i = begin; i < end; ++i) {
    double light = 0;
    const auto keep = [&] { cells.light[static_cast<std::size_t>(i)] = static_cast<float>(light); };
    const double a = std::max<double>(i, first), b = std::min<double>(i + 1, last);
    if (a - first > kRim && last - b > kRim) {
      light = at(i + 0.5);
      keep();
      continue;
    }
    // x = rim ± u²
    const bool left = a - first < last - b;
    const double from = std::sqrt(std::max(0.0, left ? a - first : last - b));
    const double to = std::sqrt(std::max(0.0, left ? b - first : last - a));
    for (std::size_t k = 0; k < rule.node.size(); ++k) {
      const double u = from + (rule.node[k] + 0.5) * (to - from);
      light += rule.weight[k] * 2 * u / (from + to) * at(left ? first + u * u : last - u * u);
    }
    keep();
  }
}

// Share of each cell that a bar leaves free which lies along the lines rather than across: its edge
// is met in the cell's middle column, where the share of the line's height is exact.
void SphereRenderer::free_line(const InkedLine& line, Columns& cells) const {
  const OccludingBar& bar = *scene_.bar;
  const Vec along = direction(bar.angle_deg);
  const double half = bar.width_px / 2, reach = line.step * std::abs(along.x);
  const auto [begin, end] = cells.reach(line.cut.outline());
  for (int i = begin; i < end; ++i) {
    const double off = (line.y - bar.y_px) * along.x - (cells.middle(i) - bar.x_px) * along.y;
    const double hidden = std::min(off + reach / 2, half) - std::max(off - reach / 2, -half);
    cells.free[static_cast<std::size_t>(i)] = static_cast<float>(1 - std::max(0.0, hidden) / reach);
  }
}

void SphereRenderer::add_line(const SphereView& view, InkedLine& line, Columns& cells) const {
  if (line.cut.empty()) return;
  const Span outline = line.cut.outline();
  std::array<Span, 2> seen{outline, Span{1, 0}};
  if (scene_.bar) {
    const OccludingBar& bar = *scene_.bar;
    const Vec along = direction(bar.angle_deg);
    if (std::abs(along.x) > std::abs(along.y)) {
      free_line(line, cells);
    } else if (const Span hidden = strip((line.y - bar.y_px) * along.x + bar.x_px * along.y,
                                         -along.y, bar.width_px / 2);
               !hidden.empty()) {
      seen = {meet(outline, {-1e30, hidden.first}), meet(outline, {hidden.last, 1e30})};
    }
  }
  join(line.ink);
  for (const Span& part : seen) {
    cells.add(cells.ball, part);
    for (const Span& span : line.ink) cells.add(cells.ink, meet(span, part));
    for (const Span& span : line.drawn) {
      each_gap(meet(span, part), line.ink,
               [&](const Span& gap) { cells.add(cells.ink, gap, 1.0 / kFinerLines); });
    }
  }
  if (lit_) light_line(view, line.cut, cells);
  cells.take(scene_, outline);
}

// The lines of some rows, the first of which begins at `top`. Near the ball's upper and lower end,
// where the ink is foreshortened along the columns, there are more of them.
std::vector<InkedLine> SphereRenderer::lines_of(const SphereView& view, double top,
                                                int rows) const {
  constexpr double height = 1.0 / kRowsPerPixel;
  std::vector<InkedLine> lines;
  for (int row = 0; row < rows; ++row) {
    const double y = top + row * height;
    const auto near = [&](double end) { return std::abs(y + height / 2 - end) < kEndRows; };
    const int count = near(view.rows().first) || near(view.rows().last) ? kEndLines : 1;
    for (int i = 0; i < count; ++i) {
      lines.emplace_back();
      lines.back().step = height / count;
      lines.back().y = y + (i + 0.5) * height / count;
      lines.back().row = row;
    }
  }
  return lines;
}

// The rows from `top` on, filtered along the lines, `left` the first pixel.
void SphereRenderer::draw_rows(const SphereView& view, const SphereInk& ink, int left, double top,
                               Image<float>& out) const {
  constexpr int kRowsPerBlock = kPixelsPerBlock * kRowsPerPixel;
  const int width = out.width(), rows = out.height();
  const auto count = static_cast<std::size_t>((width + 2 * halo_) * cells_per_pixel_);
  const int blocks = (rows + kRowsPerBlock - 1) / kRowsPerBlock;
  parallel_for(static_cast<std::size_t>(blocks), [&](std::size_t block) {
    const int first = static_cast<int>(block) * kRowsPerBlock,
              last = std::min(rows, first + kRowsPerBlock);
    std::vector<InkedLine> lines =
        lines_of(view, top + static_cast<double>(first) / kRowsPerPixel, last - first);
    ink.draw(lines);
    Columns cells(left - halo_ - 0.5, cells_per_pixel_, count);
    auto line = lines.begin();
    for (int row = first; row < last; ++row) {
      bool seen = false;
      const auto share = static_cast<float>(line->step * kRowsPerPixel);
      for (; line != lines.end() && line->row == row - first; ++line) {
        seen = seen || !line->cut.empty();
        add_line(view, *line, cells);
      }
      const std::span<float> to{out.row(row), static_cast<std::size_t>(width)};
      if (!seen) {
        std::fill(to.begin(), to.end(), 0.0F);
        continue;
      }
      cells.filter(across_, to);
      for (float& level : to) level *= share;
    }
  });
}

void SphereRenderer::add_picture(const SphereView& view, double weight, Image<double>& out) const {
  const Box box = box_of(view);
  if (box.left >= box.right || box.top >= box.bottom) return;
  const SphereInk ink(view, sphere_);
  const int width = box.right - box.left;
  for (int top = box.top; top < box.bottom; top += kPixelsPerBand) {
    const int bottom = std::min(box.bottom, top + kPixelsPerBand);
    Image<float> rows(width, (bottom - top + 2 * halo_) * kRowsPerPixel);
    draw_rows(view, ink, box.left, top - halo_ - 0.5, rows);
    parallel_for(static_cast<std::size_t>(bottom - top), [&](std::size_t index) {
      const int y = top + static_cast<int>(index);
      double* row = out.row(y) + box.left;
      for (std::size_t k = 0; k < down_.size(); ++k) {
        const float* from = rows.row((y - top) * kRowsPerPixel + static_cast<int>(k));
        const double w = weight * down_[k];
        for (int x = 0; x < width; ++x) row[x] += w * static_cast<double>(from[x]);
      }
    });
  }
}

Image<double> SphereRenderer::exact(const BallPose& pose) const {
  return exact(ShutterPath{pose, pose, pose});
}

Image<double> SphereRenderer::exact(const ShutterPath& path) const {
  Image<double> out = backdrop_;
  const double per_z = scene_.distance_radii > 0 ? 1 / scene_.distance_radii : 0;
  for (const auto& [pose, weight] : instants_of(path, sphere_.radius_px, per_z)) {
    add_picture(SphereView(pose, sphere_.radius_px, scene_), weight, out);
  }
  return out;
}

void SphereRenderer::render(const ShutterPath& path, std::int64_t frame_index, Frame& out) const {
  Image<double> grey = exact(path);
  develop(grey, scene_, frame_index, out);
}

}  // namespace impactdic::sim::speckle
