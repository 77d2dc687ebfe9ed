#include "sim/speckle/sphere/sphere_ink.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace impactdic::sim::speckle {
namespace {

// Hurwitz' zeta function at -1/2 and -3/2, 0 <= a <= 1, by the Euler-Maclaurin formula; error 1e-6.
double zeta_minus_half(double a) {
  double sum = 0;
  for (int n = 0; n < 3; ++n) sum += std::sqrt(a + n);
  const double x = a + 3, root = std::sqrt(x);
  return sum + root / 2 - x * root * 2 / 3 - 1 / (24 * root) + 1 / (1920 * x * x * root);
}
double zeta_minus_three_halves(double a) {
  double sum = 0;
  for (int n = 0; n < 3; ++n) sum += (a + n) * std::sqrt(a + n);
  const double x = a + 3, root = std::sqrt(x);
  return sum + x * root / 2 - x * x * root * 2 / 5 - root / 8 - 1 / (1920 * x * root);
}

double square(double value) { return value * value; }

}  // namespace

void join(std::vector<Span>& spans) {
  std::sort(spans.begin(), spans.end(),
            [](const Span& a, const Span& b) { return a.first < b.first; });
  std::size_t kept = 0;
  for (std::size_t i = 1; i < spans.size(); ++i) {
    if (spans[i].first <= spans[kept].last) {
      spans[kept].last = std::max(spans[kept].last, spans[i].last);
    } else {
      spans[++kept] = spans[i];
    }
  }
  if (!spans.empty()) spans.resize(kept + 1);
}

double first_width(const std::array<double, 3>& square, const std::array<double, 3>& y,
                   double step) {
  const double width = std::sqrt(square[0]);
  const double u1 = std::abs(y[1] - y[0]), u2 = std::abs(y[2] - y[0]);
  const double rise1 = (square[1] - square[0]) / u1, rise2 = (square[2] - square[0]) / u2;
  const double curve = (rise2 - rise1) / (u2 - u1), slope = rise1 - curve * u1;
  const double root = slope * slope - 4 * square[0] * curve;
  if (!(root > 0) || !(slope > 0)) return width;
  const double before = 2 * square[0] / (slope + std::sqrt(root));  // the end lies there
  const double at_end = slope - 2 * curve * before;
  if (!(at_end > 0)) return width;
  const double a = std::min(1.0, before / step);
  const double first = std::sqrt(at_end), second = curve / (2 * first);
  return std::max(0.0, width - std::sqrt(step) * (first * zeta_minus_half(a) +
                                                  second * step * zeta_minus_three_halves(a)));
}

SphereInk::SphereInk(const SphereView& view, const SpeckleSphere& sphere) : view_(view) {
  const double r = sphere.radius_px;
  for (const InkCap& cap : sphere.caps) {
    const Eigen::Vector3d centre = view.turn() * cap.centre;
    const Span rows = view.rows_of(centre, cap.radius_px);
    if (rows.empty()) continue;
    caps_.push_back({{centre, std::sqrt(r * r - cap.radius_px * cap.radius_px)}, rows});
  }
  for (const InkStrip& strip : sphere.strips) {
    const Eigen::Vector3d middle = view.turn() * strip.middle, along = view.turn() * strip.along;
    const Eigen::Vector3d across = middle.cross(along);
    const double half = strip.length_px / 2 / r, side = r * std::sin(strip.width_px / 2 / r);
    const Eigen::Vector3d up = std::sin(half) * middle, ahead = std::cos(half) * along;
    strips_.push_back({{{across, -side}, {-across, -side}, {up + ahead, 0}, {up - ahead, 0}}});
  }
}

// The first and the last line of the ball get the width that makes its area right.
void SphereInk::cut(InkedLine& line) const {
  line.ink.clear();
  line.drawn.clear();
  line.cut = view_.line(line.y);
  if (line.cut.empty()) return;
  for (const double step : {line.step, -line.step}) {
    if (!view_.line(line.y - step).empty()) continue;
    std::array<double, 3> squares, y;
    for (std::size_t i = 0; i < 3; ++i) {
      y[i] = line.y + static_cast<double>(i) * step;
      const SphereLine next = view_.line(y[i]);
      if (next.empty()) return;
      squares[i] = square(next.outline().last - next.outline().first);
    }
    line.cut.widen(first_width(squares, y, line.step) / std::sqrt(squares[0]));
    return;
  }
}

void SphereInk::draw_cap(const Cap& cap, std::vector<InkedLine>& lines,
                         std::vector<Stretches>& seen) const {
  if (cap.rows.first > lines.back().y || cap.rows.last < lines.front().y) return;
  const auto below = [](const InkedLine& line, double y) { return line.y < y; };
  const auto first = std::lower_bound(lines.begin(), lines.end(), cap.rows.first, below);
  const auto begin = first - lines.begin();
  const auto end = std::lower_bound(first, lines.end(), cap.rows.last, below) - lines.begin();
  const auto cut_by = [&](const SphereLine& line) {
    return line.empty() ? Stretches() : line.stretches(cap.inside.w, cap.inside.b);
  };
  seen.clear();
  for (auto l = begin; l < end; ++l) {
    seen.push_back(cut_by(lines[static_cast<std::size_t>(l)].cut));
  }
  const auto count = static_cast<std::ptrdiff_t>(lines.size());
  const auto y_of = [&](std::ptrdiff_t l) {
    if (l < 0) return lines.front().y + static_cast<double>(l) * lines.front().step;
    if (l < count) return lines[static_cast<std::size_t>(l)].y;
    return lines.back().y + static_cast<double>(l - count + 1) * lines.back().step;
  };
  const auto look = [&](std::ptrdiff_t l) {
    if (l >= begin && l < end) return seen[static_cast<std::size_t>(l - begin)];
    const double y = y_of(l);
    return y < cap.rows.first || y > cap.rows.last ? Stretches() : cut_by(view_.line(y));
  };
  const auto width = [](const Stretches& s) { return s.span[0].last - s.span[0].first; };
  for (auto l = begin; l < end; ++l) {
    const Stretches& here = seen[static_cast<std::size_t>(l - begin)];
    InkedLine& line = lines[static_cast<std::size_t>(l)];
    double wider = 1;
    for (const int ahead : {1, -1}) {
      if (!here.whole || look(l - ahead).count > 0) continue;
      const Stretches second = look(l + ahead), third = look(l + 2 * ahead);
      if (!second.whole || !third.whole) continue;
      wider = first_width({square(width(here)), square(width(second)), square(width(third))},
                          {line.y, y_of(l + ahead), y_of(l + 2 * ahead)}, line.step) /
              width(here);
    }
    for (int i = 0; i < here.count; ++i) {
      const Span& span = here.span[static_cast<std::size_t>(i)];
      const double middle = (span.first + span.last) / 2, half = wider * (span.last - middle);
      line.ink.push_back({middle - half, middle + half});
    }
  }
}

// A straight edge that lies nearly along the lines would be seen late or early by half a step; the
// strips are therefore cut by finer lines.
void SphereInk::draw_strips(InkedLine& line) const {
  std::vector<Span> spans;
  for (int i = 0; i < kFinerLines; ++i) {
    spans.clear();
    const SphereLine cut = view_.line(line.y + ((i + 0.5) / kFinerLines - 0.5) * line.step);
    if (cut.empty()) continue;
    for (const auto& strip : strips_) {
      Stretches seen = cut.stretches(strip[0].w, strip[0].b);
      for (std::size_t k = 1; k < strip.size() && seen.count > 0; ++k) {
        seen = meet(seen, cut.stretches(strip[k].w, strip[k].b));
      }
      for (int k = 0; k < seen.count; ++k) {
        spans.push_back(seen.span[static_cast<std::size_t>(k)]);
      }
    }
    join(spans);  // where strips cross
    line.drawn.insert(line.drawn.end(), spans.begin(), spans.end());
  }
}

void SphereInk::draw(std::vector<InkedLine>& lines) const {
  for (InkedLine& line : lines) {
    cut(line);
    if (!line.cut.empty() && !strips_.empty()) draw_strips(line);
  }
  std::vector<Stretches> seen;
  for (const Cap& cap : caps_) draw_cap(cap, lines, seen);
}

}  // namespace impactdic::sim::speckle
