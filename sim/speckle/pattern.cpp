#include "sim/speckle/pattern.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "sim/speckle/blur.h"
#include "sim/speckle/pattern_parts.h"
#include "sim/speckle/placement.h"
#include "sim/speckle/render.h"

namespace impactdic::sim::speckle {
namespace {

constexpr double kLensSigma = 0.6;          // of the pictures in which sizes are stated, px
constexpr double kLogAreaDeviation = 0.25;  // of ln(area), (a)–(d)
constexpr int kAttempts = 16;
// Speckles that are placed lie in layers along the edge of what they are placed on: it is so far
// beyond the rim that there they lie as inside, px.
constexpr double kBeyond = 30;
constexpr double kBlurredIn = 10;  // ink so far beyond the rim is blurred into the ball, px

// Lens and pixel square together, as one Gaussian of the same variance.
double picture_sigma() { return std::sqrt(kLensSigma * kLensSigma + 1.0 / 12); }

constexpr float kDark =
    0.55F;  // share of ink from which on a place is dark, whatever else is there

// A disc of a cluster in its picture. Where its ink alone decides, the distance need not be exact.
struct PicturedDisc {
  PicturedDisc(const InkDisc& disc, double scale, std::size_t discs)
      : x_px(disc.x_px * scale),
        y_px(disc.y_px * scale),
        ink(disc.radius_px * scale, picture_sigma(), 0, 0.6),  // a margin to what is dark
        dark_within_2(squared_distance(kDark)),
        clear_beyond_2(squared_distance(0.4F / static_cast<float>(discs))) {}

  // Ink falls with the distance: squared distance at which it falls through `level`, px².
  double squared_distance(float level) const {
    double within = 0, beyond = ink.reach_px();
    for (int i = 0; i < 12; ++i) {
      const double middle = (within + beyond) / 2;
      (ink(middle) > level ? within : beyond) = middle;
    }
    return level == kDark ? within * within : beyond * beyond;
  }

  double x_px, y_px;
  BlurredDisc ink;
  double dark_within_2, clear_beyond_2;  // px²
};

// Whether the discs' joint picture is darker than half level at a point, px.
bool is_dark(const std::vector<PicturedDisc>& discs, double x, double y) {
  bool is_near = false;
  for (const PicturedDisc& d : discs) {
    const double dx = x - d.x_px, dy = y - d.y_px, apart_2 = dx * dx + dy * dy;
    if (apart_2 < d.dark_within_2) return true;
    is_near = is_near || apart_2 < d.clear_beyond_2;
  }
  if (!is_near) return false;
  float clear = 1;
  for (const PicturedDisc& d : discs) clear *= 1 - d.ink(std::hypot(x - d.x_px, y - d.y_px));
  return clear < 0.5F;
}

// Area over which the discs' joint picture is darker than half level, px².
double half_level_area(const std::vector<InkDisc>& discs, double scale) {
  std::vector<PicturedDisc> pictured;
  double reach = 0;
  for (const InkDisc& d : discs) {
    pictured.emplace_back(d, scale, discs.size());
    reach = std::max(reach, (std::hypot(d.x_px, d.y_px) + d.radius_px) * scale + 1);
  }
  const double step = std::max(0.2, reach / 24);
  std::vector<double> raster;  // of both axes
  for (double at = -reach; at < reach;) {
    raster.push_back(at);
    at += step;
  }
  int dark = 0;
  for (const double y : raster) {
    for (const double x : raster) dark += is_dark(pictured, x, y);
  }
  return dark * step * step;
}

SpeckleBall paint(const PatternSpec& spec, double radius_px, int count, Random& random) {
  SpeckleBall ball;
  ball.radius_px = radius_px;
  Placement placement(radius_px + kBeyond);
  for (const double area : draw_areas(spec, count, random)) {
    const std::vector<InkDisc> shape = spec.clusters
                                           ? make_cluster(area, random)
                                           : std::vector<InkDisc>{{0, 0, disc_radius_for(area)}};
    placement.place(shape, random);
  }
  if (!spec.clusters) placement.spread(kSpeckleGap);
  for (const InkDisc& disc : placement.discs()) {
    const double rim_px = std::hypot(disc.x_px, disc.y_px) - disc.radius_px;
    if (rim_px < radius_px + kBlurredIn) ball.discs.push_back(disc);
  }
  for (int i = 0; i < spec.lines; ++i) {
    // Directions spread evenly with some scatter, so that some line crosses any motion.
    const double away = 0.5 * radius_px * std::sqrt(random.uniform());
    const double angle = 2 * kPi * random.uniform();
    ball.lines.push_back({away * std::cos(angle), away * std::sin(angle),
                          180.0 / spec.lines * (i + random.uniform()),
                          radius_px * (0.8 + 1.0 * random.uniform()), kLineWidth});
  }
  return ball;
}

// 8-connected areas of the dark pixels that do not reach out of the ball, px².
std::vector<int> dark_areas(const Image<double>& picture, double level, double radius_px) {
  const int width = picture.width(), middle = width / 2;
  Image<std::uint8_t> seen(width, width, 0);
  std::vector<int> areas;
  std::vector<std::pair<int, int>> todo;
  for (int y0 = 1; y0 < width - 1; ++y0) {
    for (int x0 = 1; x0 < width - 1; ++x0) {
      if (seen(x0, y0) || picture(x0, y0) >= level) continue;
      int area = 0;
      bool cut = false;
      seen(x0, y0) = 1;
      todo.assign(1, {x0, y0});
      while (!todo.empty()) {
        const auto [x, y] = todo.back();
        todo.pop_back();
        ++area;
        cut = cut || std::hypot(x - middle, y - middle) > radius_px - 1;
        for (int v = std::max(0, y - 1); v <= std::min(width - 1, y + 1); ++v) {
          for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u) {
            if (seen(u, v) || picture(u, v) >= level) continue;
            seen(u, v) = 1;
            todo.emplace_back(u, v);
          }
        }
      }
      if (!cut) areas.push_back(area);
    }
  }
  return areas;
}

}  // namespace

double disc_radius_for(double area_px) {
  const double half_level_radius = std::sqrt(area_px / kPi);
  double low = 0.2, high = half_level_radius + 2;
  for (int i = 0; i < 24; ++i) {
    const double r = (low + high) / 2;
    const BlurredDisc disc(r, picture_sigma(), half_level_radius);
    (disc(half_level_radius) < 0.5F ? low : high) = r;
  }
  return (low + high) / 2;
}

std::vector<InkDisc> make_cluster(double area_px, Random& random) {
  const int count = 2 + static_cast<int>(random.uniform() * std::min(5.0, 1 + area_px / 8));
  std::vector<InkDisc> discs{{0, 0, 1}};
  while (static_cast<int>(discs.size()) < count) {
    const InkDisc from = discs[static_cast<std::size_t>(random.uniform() * discs.size())];
    const double angle = 2 * kPi * random.uniform();
    const double radius = 0.5 + 0.5 * random.uniform();
    const double away = from.radius_px * (0.6 + 0.7 * random.uniform());
    discs.push_back(
        {from.x_px + away * std::cos(angle), from.y_px + away * std::sin(angle), radius});
  }
  double scale = std::sqrt(area_px / (kPi * 1.6));
  for (int i = 0; i < 8; ++i) {
    const double area = half_level_area(discs, scale);
    if (std::abs(area - area_px) < 0.02 * area_px) break;
    scale *= area > 0 ? std::clamp(std::sqrt(area_px / area), 0.6, 1.6) : 1.4;
  }
  for (InkDisc& d : discs) d = {d.x_px * scale, d.y_px * scale, d.radius_px * scale};
  return discs;
}

std::vector<double> draw_areas(const PatternSpec& spec, int count, Random& random) {
  std::vector<double> areas;
  if (spec.mean_area_px > 0) {
    double sum = 0;
    for (int i = 0; i < count; ++i) {
      areas.push_back(std::exp(kLogAreaDeviation * random.normal()));
      sum += areas.back();
    }
    for (double& area : areas) area *= spec.mean_area_px * count / sum;
  } else {
    for (int i = 0; i < count; ++i) {
      const double rank = (i + random.uniform()) / count;
      areas.push_back(spec.min_area_px * std::pow(spec.max_area_px / spec.min_area_px, rank));
    }
  }
  std::sort(areas.rbegin(), areas.rend());
  return areas;
}

double mean_area(const PatternSpec& spec) {
  if (spec.mean_area_px > 0) return spec.mean_area_px;
  return (spec.max_area_px - spec.min_area_px) / std::log(spec.max_area_px / spec.min_area_px);
}

const std::vector<PatternSpec>& pattern_specs() {
  static const std::vector<PatternSpec> specs = {
      {"a1", 0.09, 4},
      {"a2", 0.17, 4},
      {"a3", 0.24, 4},
      {"b1", 0.13, 10},
      {"b2", 0.19, 10},
      {"b3", 0.31, 10},
      {"c1", 0.14, 20},
      {"c2", 0.18, 20},
      {"c3", 0.27, 20},
      {"d1", 0.22, 250},
      {"d2", 0.30, 250},
      {"d3", 0.43, 250},
      {"e1", 0.54, 0, 4, 80, true},
      {"e2", 0.60, 0, 2, 40, true},
      {"f1", 0.27, 0, 4, 20, false, 5},
      {"f2", 0.52, 0, 4, 80, false, 5},
  };
  return specs;
}

const PatternSpec& find_pattern(const std::string& name) {
  for (const PatternSpec& spec : pattern_specs()) {
    if (name == spec.name) return spec;
  }
  throw InvalidArgument("no such speckle pattern", name,
                        "a1 … a3, b1 … b3, c1 … c3, d1 … d3, e1, e2, f1, f2");
}

InkMeasure measure_ink(const SpeckleBall& ball) {
  SynthScene scene;
  const int middle = static_cast<int>(std::ceil(ball.radius_px)) + 4;
  scene.width = scene.height = 2 * middle + 1;
  scene.white = scene.background = 255;
  scene.ink = 0;
  scene.psf_sigma_px = kLensSigma;
  const double centre = middle;
  const Image<double> picture = BallRenderer(ball, scene).exact(BallPose{centre, centre});
  const double level = 127.5;
  int dark = 0, all = 0;
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      if (std::hypot(x - centre, y - centre) > ball.radius_px) continue;
      ++all;
      dark += picture(x, y) < level;
    }
  }
  const std::vector<int> areas = dark_areas(picture, level, ball.radius_px);
  InkMeasure measure;
  measure.density = static_cast<double>(dark) / all;
  measure.speckles = static_cast<int>(areas.size());
  double sum = 0;
  for (const int area : areas) sum += area;
  measure.mean_area_px = areas.empty() ? 0 : sum / static_cast<double>(areas.size());
  return measure;
}

// Paints, measures, corrects the number of speckles and paints again until the ball is what the
// source states; of all attempts the best.
SpeckleBall paint_ball(const std::string& pattern, std::uint64_t seed, double radius_px) {
  const PatternSpec& spec = find_pattern(pattern);
  if (!(radius_px >= 20 && radius_px <= 2000)) {
    throw InvalidArgument("the ball's radius is out of range", "radius", "20 … 2000 px");
  }
  const double reach = radius_px + kBeyond;
  double count = spec.density * kPi * reach * reach / mean_area(spec);
  SpeckleBall best;
  double best_error = 1e9;
  for (int attempt = 0; attempt < kAttempts && best_error > 1; ++attempt) {
    Random random(seed, static_cast<std::uint64_t>(attempt));
    const SpeckleBall ball =
        paint(spec, radius_px, std::max(1, static_cast<int>(std::lround(count))), random);
    const InkMeasure ink = measure_ink(ball);
    // 1 where both lie well within what is promised.
    double error = std::abs(ink.density - spec.density) / 0.003;
    if (spec.mean_area_px > 0) {
      const double promised = spec.name == std::string("a3") ? 0.13 : 0.05;
      error =
          std::max(error, std::abs(ink.mean_area_px / spec.mean_area_px - 1) / (0.8 * promised));
    }
    if (error < best_error) {
      best_error = error;
      best = ball;
    }
    count *= std::clamp(spec.density / std::max(ink.density, 1e-3), 0.7, 1.4);
  }
  return best;
}

}  // namespace impactdic::sim::speckle
