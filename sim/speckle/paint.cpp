// What one instant of the ball adds to the rows of a picture.
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "sim/speckle/render_parts.h"

namespace impactdic::sim::speckle {
void BallRenderer::paint_discs(const Placed& placed, Band& band) const {
  std::vector<double> squared(band.x.size());  // distances of samples from the centre, px²
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
        if (to <= from) return;
        for (int s = from; s < to; ++s) {
          squared[static_cast<std::size_t>(s - from)] =
              placed.squared(band.x[static_cast<std::size_t>(s)] - centre.x, dy);
        }
        ink.cover(squared.data(), to - from, clear + from);
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
      if (scene_.bar) value *= 1 - bar_coverage(scene_, band.x[i], y);
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

}  // namespace impactdic::sim::speckle
