#include "sim/speckle/sphere/sphere.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "sim/speckle/pattern_parts.h"
#include "sim/speckle/sphere/sphere_placement.h"

namespace impactdic::sim::speckle {
namespace {

constexpr int kSphereAttempts = 12;
constexpr int kClusterShapes = 400;   // different ones; every copy is turned at random
constexpr int kStripPieces = 24;      // a strip laid flat is a chain of short lines
constexpr double kPatchAngle = 0.55;  // rad; half the angle between neighbours of an icosahedron

// Clusters of areas that rise evenly in ln(area), to choose from.
class Clusters {
 public:
  Clusters(const PatternSpec& spec, Random& random)
      : low_(spec.min_area_px), ratio_(spec.max_area_px / spec.min_area_px) {
    for (int i = 0; i < kClusterShapes; ++i) {
      shapes_.push_back(make_cluster(area(i), random));
    }
  }
  // A shape of about that area, scaled to it.
  std::vector<InkDisc> get(double area_px) const {
    const int i =
        std::clamp(static_cast<int>(std::log(area_px / low_) / std::log(ratio_) * kClusterShapes),
                   0, kClusterShapes - 1);
    std::vector<InkDisc> shape = shapes_[static_cast<std::size_t>(i)];
    const double scale = std::sqrt(area_px / area(i));
    for (InkDisc& d : shape) d = {d.x_px * scale, d.y_px * scale, d.radius_px * scale};
    return shape;
  }

 private:
  double area(int i) const { return low_ * std::pow(ratio_, (i + 0.5) / kClusterShapes); }

  double low_, ratio_;
  std::vector<std::vector<InkDisc>> shapes_;
};

InkStrip random_strip(double radius_px, Random& random) {
  InkStrip strip;
  strip.middle = random_direction(random);
  const TangentPlane plane(strip.middle);
  const double angle = 2 * kPi * random.uniform();
  strip.along = std::cos(angle) * plane.u + std::sin(angle) * plane.v;
  strip.length_px = radius_px * (0.8 + 1.0 * random.uniform());
  strip.width_px = kLineWidth;
  return strip;
}

SpeckleSphere paint(const PatternSpec& spec, const Clusters* clusters, double radius_px, int count,
                    Random& random) {
  SpeckleSphere sphere;
  sphere.radius_px = radius_px;
  SpherePlacement placement(radius_px);
  for (const double area : draw_areas(spec, count, random)) {
    placement.place(
        clusters ? clusters->get(area) : std::vector<InkDisc>{{0, 0, disc_radius_for(area)}},
        random);
  }
  if (!spec.clusters) placement.spread(kSpeckleGap);
  sphere.caps = placement.caps();
  // Four times the area of the disc that the source's lines are drawn on.
  for (int i = 0; i < 4 * spec.lines; ++i) sphere.strips.push_back(random_strip(radius_px, random));
  return sphere;
}

std::array<Eigen::Vector3d, 12> icosahedron() {
  const double golden = (1 + std::sqrt(5.0)) / 2;
  std::array<Eigen::Vector3d, 12> corners;
  std::size_t n = 0;
  for (const double a : {-1.0, 1.0}) {
    for (const double b : {-golden, golden}) {
      corners[n++] = Eigen::Vector3d(0, a, b).normalized();
      corners[n++] = Eigen::Vector3d(a, b, 0).normalized();
      corners[n++] = Eigen::Vector3d(b, 0, a).normalized();
    }
  }
  return corners;
}

// The ink about a point of the sphere, laid flat by Lambert's azimuthal equal-area projection.
SpeckleBall flat_patch(const SpeckleSphere& sphere, const Eigen::Vector3d& at) {
  const TangentPlane plane(at);
  const double r = sphere.radius_px;
  const auto flat = [&](const Eigen::Vector3d& p) -> Eigen::Vector2d {
    const double scale = r * std::sqrt(2 / (1 + p.dot(at)));
    return {scale * p.dot(plane.u), scale * p.dot(plane.v)};
  };
  SpeckleBall patch;
  patch.radius_px = 2 * r * std::sin(kPatchAngle / 2);
  for (const InkCap& cap : sphere.caps) {
    const double half = std::asin(cap.radius_px / r);
    if (std::acos(std::clamp(cap.centre.dot(at), -1.0, 1.0)) > kPatchAngle + half) continue;
    const Eigen::Vector2d middle = flat(cap.centre);
    patch.discs.push_back({middle.x(), middle.y(), 2 * r * std::sin(half / 2)});
  }
  for (const InkStrip& strip : sphere.strips) {
    const auto point = [&](int i) -> Eigen::Vector3d {
      const double arc = strip.length_px / r * (static_cast<double>(i) / kStripPieces - 0.5);
      return std::cos(arc) * strip.middle + std::sin(arc) * strip.along;
    };
    for (int i = 0; i < kStripPieces; ++i) {
      if (point(i).dot(at) < std::cos(kPatchAngle) - 0.2) continue;
      const Eigen::Vector2d a = flat(point(i)), b = flat(point(i + 1)), way = b - a;
      patch.lines.push_back({(a.x() + b.x()) / 2, (a.y() + b.y()) / 2,
                             -std::atan2(way.y(), way.x()) / kRadPerDeg, way.norm(),
                             strip.width_px});
    }
  }
  return patch;
}

}  // namespace

InkMeasure measure_ink(const SpeckleSphere& sphere) {
  InkMeasure sum;
  for (const Eigen::Vector3d& at : icosahedron()) {
    const InkMeasure patch = measure_ink(flat_patch(sphere, at));
    sum.density += patch.density / 12;
    sum.mean_area_px += patch.mean_area_px * patch.speckles;
    sum.speckles += patch.speckles;
  }
  if (sum.speckles > 0) sum.mean_area_px /= sum.speckles;
  return sum;
}

// Paints, measures, corrects the number of speckles and paints again until the density is what the
// source states; of all attempts the best.
SpeckleSphere paint_sphere(const std::string& pattern, std::uint64_t seed, double radius_px) {
  const PatternSpec& spec = find_pattern(pattern);
  if (!(radius_px >= 20 && radius_px <= 2000)) {
    throw InvalidArgument("the ball's radius is out of range", "radius", "20 … 2000 px");
  }
  Random shapes(seed, kSphereAttempts);
  std::vector<Clusters> clusters;
  if (spec.clusters) clusters.emplace_back(spec, shapes);
  double count = spec.density * 4 * kPi * radius_px * radius_px / mean_area(spec);
  SpeckleSphere best;
  double best_error = 1e9;
  for (int attempt = 0; attempt < kSphereAttempts && best_error > 0.003; ++attempt) {
    Random random(seed, static_cast<std::uint64_t>(attempt));
    const SpeckleSphere sphere =
        paint(spec, clusters.empty() ? nullptr : &clusters.front(), radius_px,
              std::max(1, static_cast<int>(std::lround(count))), random);
    const double density = measure_ink(sphere).density;
    const double error = std::abs(density - spec.density);
    if (error < best_error) {
      best_error = error;
      best = sphere;
    }
    count *= std::clamp(spec.density / std::max(density, 1e-3), 0.7, 1.4);
  }
  return best;
}

}  // namespace impactdic::sim::speckle
