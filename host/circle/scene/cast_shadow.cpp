#include "host/circle/scene/cast_shadow.h"

#include <impactdic/units.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "host/base/statistics.h"
#include "host/circle/rays/frame_level.h"
#include "host/circle/settings/search.h"

namespace impactdic::circle {
namespace {

std::optional<double> grey_at(const Frame& frame, double x_px, double y_px) {
  const int x = static_cast<int>(std::lround(x_px)), y = static_cast<int>(std::lround(y_px));
  if (x < 0 || y < 0 || x >= frame.width() || y >= frame.height()) return std::nullopt;
  return level_at(frame, x, y);
}

// The middle of the narrowest interval that holds so many of some values, which are sorted
// (Rousseeuw, Leroy 1988: the shorth is the same of a half).
double densest(const std::vector<double>& sorted, std::size_t many) {
  std::size_t best = 0;
  for (std::size_t i = 0; i + many < sorted.size(); ++i) {
    if (sorted[i + many] - sorted[i] < sorted[best + many] - sorted[best]) best = i;
  }
  return (sorted[best] + sorted[best + many]) / 2;
}

// Along a radius of the circle, pixel by pixel inwards; short where the picture ends.
struct Radius {
  double cosine = 1, sine = 0;
  double from_px = 0;
  std::vector<double> greys;
};

class Radii {
 public:
  Radii(const Frame& frame, const Circle& circle) : circle_(circle) {
    std::vector<double> outside;
    for (int k = 0; k < kCastShadow.rays; ++k) {
      const double at = 2 * kPi * k / kCastShadow.rays;
      Radius ray{std::cos(at), std::sin(at), kCastShadow.begin * circle.r_px, {}};
      for (double r_px = ray.from_px; r_px > kCastShadow.end * circle.r_px; r_px -= 1) {
        const auto grey = grey_at(frame, x_of(ray, r_px), y_of(ray, r_px));
        if (!grey) break;
        ray.greys.push_back(*grey);
      }
      const double r_px = kCastShadow.outer * circle.r_px;
      if (const auto grey = grey_at(frame, x_of(ray, r_px), y_of(ray, r_px))) {
        outside.push_back(*grey);
      }
      in_belt_ +=
          std::min(static_cast<std::size_t>(kCastShadow.belt * circle.r_px), ray.greys.size());
      rays_.push_back(std::move(ray));
    }
    about_ = outside.empty() ? 0 : upper_median(std::move(outside));
  }

  // Of what is darker than the surroundings under the rim, the levels that most of it has, at most
  // so many: the shadow's and the ink's.
  std::vector<double> levels(int most) const {
    std::vector<double> levels, greys = belt();
    const auto many = static_cast<std::size_t>(kCastShadow.of_belt * static_cast<double>(in_belt_));
    while (static_cast<int>(levels.size()) < most && greys.size() > many) {
      levels.push_back(densest(greys, many));
      std::erase_if(greys, [&](double grey) { return is_flat(grey, levels.back()); });
    }
    return levels;
  }

  // Where the belt of that level under the rim ends inwards, on every ray that shows one.
  std::vector<Eigen::Vector2d> ends(double level) const {
    std::vector<Eigen::Vector2d> ends;
    for (const Radius& ray : rays_) {
      if (const auto r_px = end_of(ray, level)) {
        ends.emplace_back(x_of(ray, *r_px), y_of(ray, *r_px));
      }
    }
    return ends;
  }

 private:
  double x_of(const Radius& ray, double r_px) const { return circle_.cx_px + r_px * ray.cosine; }
  double y_of(const Radius& ray, double r_px) const { return circle_.cy_px + r_px * ray.sine; }

  bool is_flat(double grey, double level) const {
    return std::abs(grey - level) < kCastShadow.near * (about_ - level);
  }

  // Of the samples under the rim the dark ones, ascending.
  std::vector<double> belt() const {
    std::vector<double> greys;
    for (const Radius& ray : rays_) {
      const auto belt = static_cast<std::size_t>(kCastShadow.belt * circle_.r_px);
      for (std::size_t i = 0; i < std::min(belt, ray.greys.size()); ++i) {
        if (ray.greys[i] < kCastShadow.darker * about_) greys.push_back(ray.greys[i]);
      }
    }
    std::sort(greys.begin(), greys.end());
    return greys;
  }

  std::optional<double> end_of(const Radius& ray, double level) const {
    // The shadow's own edge is soft.
    const auto soft = static_cast<std::size_t>(kCastShadow.soft * circle_.r_px);
    std::size_t first = 0;
    while (first < std::min(soft, ray.greys.size()) && !is_flat(ray.greys[first], level)) ++first;
    std::size_t last = first;
    while (last < ray.greys.size() && is_flat(ray.greys[last], level)) ++last;
    if (last - first < kCastShadow.least_px || last == ray.greys.size()) return std::nullopt;
    return ray.from_px - static_cast<double>(last) + 0.5;
  }

  Circle circle_;
  std::vector<Radius> rays_;
  std::size_t in_belt_ = 0;
  double about_ = 0;
};

// Least squares of x^2 + y^2 = 2 a x + 2 b y + c (Kåsa 1976).
std::optional<Circle> circle_through(const std::vector<Eigen::Vector2d>& points) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const Eigen::Vector2d& p : points) {
    const Eigen::Vector3d row(2 * (p - points[0]).x(), 2 * (p - points[0]).y(), 1);
    normal += row * row.transpose();
    right += (p - points[0]).squaredNorm() * row;
  }
  const Eigen::FullPivLU<Eigen::Matrix3d> lu(normal);
  if (!lu.isInvertible()) return std::nullopt;
  const Eigen::Vector3d x = lu.solve(right);
  const double squared = x[2] + x[0] * x[0] + x[1] * x[1];
  if (!(squared > 0)) return std::nullopt;
  return Circle{points[0].x() + x[0], points[0].y() + x[1], std::sqrt(squared)};
}

std::vector<Eigen::Vector2d> near(const std::vector<Eigen::Vector2d>& points, const Circle& c) {
  std::vector<Eigen::Vector2d> found;
  for (const Eigen::Vector2d& p : points) {
    const double off_px = std::hypot(p.x() - c.cx_px, p.y() - c.cy_px) - c.r_px;
    if (std::abs(off_px) < kCastShadow.on_rim_px) found.push_back(p);
  }
  return found;
}

bool same_size(double a_px, double b_px) {
  return std::abs(a_px - b_px) < kCastShadow.same_size * b_px;
}

// Of points in order those on the circle that most lie on; none where these are few.
std::vector<Eigen::Vector2d> on_one_circle(const std::vector<Eigen::Vector2d>& points,
                                           double about_r_px) {
  const std::size_t count = points.size(), apart = count / 4;
  if (static_cast<double>(count) < kCastShadow.least_arc * kCastShadow.rays) return {};
  std::vector<Eigen::Vector2d> most;
  for (std::size_t i = 0; i + 2 * apart < count; ++i) {
    const auto through = circle_through({points[i], points[i + apart], points[i + 2 * apart]});
    if (!through || !same_size(through->r_px, about_r_px)) continue;
    std::vector<Eigen::Vector2d> on = near(points, *through);
    if (on.size() > most.size()) most = std::move(on);
  }
  const bool agree =
      static_cast<double>(most.size()) >= kCastShadow.agree * static_cast<double>(count);
  return agree ? most : std::vector<Eigen::Vector2d>{};
}

// The mean level of some pixels along a radius of a circle.
std::optional<double> level_along(const Frame& frame, const Circle& circle, double angle,
                                  double from_px, double to_px) {
  double sum = 0, count = 0;
  for (double off_px = from_px; off_px <= to_px; off_px += 1) {
    const double r_px = circle.r_px + off_px;
    const auto grey = grey_at(frame, circle.cx_px + r_px * std::cos(angle),
                              circle.cy_px + r_px * std::sin(angle));
    if (!grey) return std::nullopt;
    sum += *grey, ++count;
  }
  return sum / count;
}

// How far a point at that angle on the rim of a circle lies outside another one, shares of its
// radius.
double beyond(const Circle& circle, double angle, const Circle& other) {
  const double x = circle.cx_px + circle.r_px * std::cos(angle) - other.cx_px;
  const double y = circle.cy_px + circle.r_px * std::sin(angle) - other.cy_px;
  return std::hypot(x, y) / other.r_px - 1;
}

}  // namespace

bool shows_beside(const Frame& frame, const Circle& thing, const Circle& shadow) {
  std::vector<double> steps, walls, darks;
  for (int k = 0; k < kCastShadow.rays; ++k) {
    const double angle = 2 * kPi * k / kCastShadow.rays;
    const auto [near_px, far_px] = kCastShadow.beside_px;
    if (beyond(shadow, angle, thing) > kCastShadow.soft) {
      const auto dark = level_along(frame, shadow, angle, -kCastShadow.soft * shadow.r_px - far_px,
                                    -kCastShadow.soft * shadow.r_px);
      if (dark) darks.push_back(*dark);
    }
    if (beyond(thing, angle, shadow) < kCastShadow.soft) continue;
    const auto inside = level_along(frame, thing, angle, -far_px, -near_px);
    const auto outside = level_along(frame, thing, angle, near_px, far_px);
    if (!inside || !outside) continue;
    steps.push_back(std::abs(*inside - *outside));
    walls.push_back(*outside);
  }
  if (darks.empty() ||
      static_cast<double>(steps.size()) < kCastShadow.least_arc * kCastShadow.rays) {
    return false;
  }
  const double contrast = upper_median(std::move(walls)) - upper_median(std::move(darks));
  const auto plain =
      std::ranges::count_if(steps, [&](double step) { return step > kCastShadow.step * contrast; });
  return contrast > 0 &&
         static_cast<double>(plain) > kCastShadow.agree * static_cast<double>(steps.size());
}

bool is_flat_dark(const Frame& frame, const Circle& disc, const Circle* before) {
  std::vector<double> inside, about;
  const double reach_px = kCastShadow.outer * disc.r_px;
  const double flat_px = (1 - kCastShadow.soft) * disc.r_px;
  for (double y = -reach_px; y <= reach_px; y += 1) {
    for (double x = -reach_px; x <= reach_px; x += 1) {
      const double r_px = std::hypot(x, y);
      if (r_px > reach_px || (r_px > flat_px && r_px < reach_px - 2)) continue;
      const double x_px = disc.cx_px + x, y_px = disc.cy_px + y;
      const bool hidden =
          before != nullptr && std::hypot(x_px - before->cx_px, y_px - before->cy_px) <
                                   kCastShadow.beyond * before->r_px;
      if (const auto grey = grey_at(frame, x_px, y_px); grey && !hidden) {
        (r_px > flat_px ? about : inside).push_back(*grey);
      }
    }
  }
  if (static_cast<double>(inside.size()) < kCastShadow.of_disc * kPi * flat_px * flat_px ||
      about.empty()) {
    return false;
  }
  const double contrast = upper_median(std::move(about)) - upper_median(inside);
  if (!(contrast > 0)) return false;
  const double level = upper_median(inside);
  const auto off = std::ranges::count_if(
      inside, [&](double grey) { return std::abs(grey - level) > kCastShadow.near * contrast; });
  return level < kCastShadow.darker * (level + contrast) &&
         static_cast<double>(off) < (before != nullptr ? kCastShadow.marked : kCastShadow.covered) *
                                        static_cast<double>(inside.size());
}

bool may_cast(const Circle& thing, const Circle& shadow) {
  const double off = std::hypot(thing.cx_px - shadow.cx_px, thing.cy_px - shadow.cy_px);
  return same_size(thing.r_px, shadow.r_px) && off > kCastShadow.least_off * shadow.r_px &&
         off < thing.r_px + shadow.r_px;
}

std::optional<Circle> what_casts(const Frame& frame, const Circle& shadow) {
  if (shadow.r_px < kCastShadow.least_r_px) return std::nullopt;
  const Radii radii(frame, shadow);
  std::vector<Eigen::Vector2d> most;
  for (const double level : radii.levels(kCastShadow.levels)) {
    std::vector<Eigen::Vector2d> on = on_one_circle(radii.ends(level), shadow.r_px);
    if (on.size() > most.size()) most = std::move(on);
  }
  if (most.empty()) return std::nullopt;
  const auto thing = circle_through(most);
  return thing && may_cast(*thing, shadow) ? thing : std::nullopt;
}

}  // namespace impactdic::circle
