#include "sim/speckle/sphere/sphere_placement.h"

#include <impactdic/units.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace impactdic::sim::speckle {
TangentPlane::TangentPlane(const Eigen::Vector3d& at) : u(at.unitOrthogonal()), v(at.cross(u)) {}

Eigen::Vector3d random_direction(Random& random) {
  const double z = 2 * random.uniform() - 1, angle = 2 * kPi * random.uniform();
  const double s = std::sqrt(1 - z * z);
  return {s * std::cos(angle), s * std::sin(angle), z};
}

SpherePlacement::SpherePlacement(double ball_radius_px)
    : radius_px_(ball_radius_px),
      gap_px_(kFirstGap),
      bands_(static_cast<int>(std::ceil(kPi * ball_radius_px / kCell))) {
  std::size_t sum = 0;
  for (int band = 0; band < bands_; ++band) {
    const double latitude = kPi * (band + 0.5) / bands_;
    const double around = 2 * kPi * ball_radius_px * std::sin(latitude);
    cells_.push_back(std::max(1, static_cast<int>(std::ceil(around / kCell))));
    first_.push_back(sum);
    sum += static_cast<std::size_t>(cells_.back());
  }
  grid_.resize(sum);
}

int SpherePlacement::band_of(double z) const {
  const double angle = std::acos(std::clamp(z, -1.0, 1.0));
  return std::clamp(static_cast<int>(angle / kPi * bands_), 0, bands_ - 1);
}

std::size_t SpherePlacement::cell(const Eigen::Vector3d& at) const {
  const auto band = static_cast<std::size_t>(band_of(at.z()));
  const double turn = std::atan2(at.y(), at.x()) / (2 * kPi) + 0.5;
  const int index = std::clamp(static_cast<int>(turn * cells_[band]), 0, cells_[band] - 1);
  return first_[band] + static_cast<std::size_t>(index);
}

template <typename Visit>
bool SpherePlacement::each_near(const Eigen::Vector3d& at, double near_px,
                                const Visit& visit) const {
  const double reach = 2 * std::asin(std::min(1.0, std::max(0.0, near_px) / (2 * radius_px_)));
  const double angle = std::acos(std::clamp(at.z(), -1.0, 1.0));
  const double turn = std::atan2(at.y(), at.x()) / (2 * kPi) + 0.5;
  // The widest stretch of longitude that the circle about `at` covers; all of it near a pole.
  const double ratio = std::sin(reach) / std::max(1e-12, std::sin(angle));
  const bool round = angle <= reach || angle >= kPi - reach || ratio >= 1;
  const double aside = round ? 0.5 : std::asin(ratio) / (2 * kPi);
  const int from = band_of(std::cos(std::max(0.0, angle - reach)));
  const int to = band_of(std::cos(std::min(kPi, angle + reach)));
  for (int band = from; band <= to; ++band) {
    const auto b = static_cast<std::size_t>(band);
    const int cells = cells_[b];
    int begin = 0, end = cells;
    if (!round) {
      begin = static_cast<int>(std::floor((turn - aside) * cells));
      end = std::min(begin + cells, static_cast<int>(std::floor((turn + aside) * cells)) + 1);
    }
    for (int i = begin; i < end; ++i) {
      for (const int other : grid_[first_[b] + static_cast<std::size_t>((i + cells) % cells)]) {
        if (!visit(static_cast<std::size_t>(other))) return false;
      }
    }
  }
  return true;
}

bool SpherePlacement::fits(const std::vector<InkCap>& shape) const {
  for (const InkCap& cap : shape) {
    const bool free =
        each_near(cap.centre, cap.radius_px + largest_px_ + gap_px_, [&](std::size_t other) {
          const InkCap& o = caps_[other];
          const double apart = cap.radius_px + o.radius_px + gap_px_;
          return apart <= 0 || (cap.centre - o.centre).norm() * radius_px_ >= apart;
        });
    if (!free) return false;
  }
  return true;
}

void SpherePlacement::place(const std::vector<InkDisc>& shape, Random& random) {
  std::vector<InkCap> laid(shape.size());
  for (int tries = 1;; ++tries) {
    const Eigen::Vector3d at = random_direction(random);
    const TangentPlane plane(at);
    const double angle = 2 * kPi * random.uniform(), c = std::cos(angle), s = std::sin(angle);
    for (std::size_t i = 0; i < shape.size(); ++i) {
      const InkDisc& d = shape[i];
      const Eigen::Vector3d aside =
          (c * d.x_px - s * d.y_px) * plane.u + (s * d.x_px + c * d.y_px) * plane.v;
      const double arc = aside.norm() / radius_px_;
      laid[i] = {
          arc > 0 ? Eigen::Vector3d(std::cos(arc) * at + std::sin(arc) * aside.normalized()) : at,
          std::min(d.radius_px, 0.95 * radius_px_)};
    }
    if (fits(laid)) break;
    if (tries % kTriesPerGap == 0) gap_px_ -= kGapStep;
  }
  for (const InkCap& cap : laid) {
    grid_[cell(cap.centre)].push_back(static_cast<int>(caps_.size()));
    caps_.push_back(cap);
    largest_px_ = std::max(largest_px_, cap.radius_px);
  }
}

bool SpherePlacement::push_apart(std::size_t index, double gap_px) {
  bool moved = false;
  const InkCap at = caps_[index];
  each_near(at.centre, at.radius_px + largest_px_ + gap_px, [&](std::size_t other) {
    if (other == index) return true;
    InkCap &a = caps_[index], &b = caps_[other];
    const Eigen::Vector3d between = b.centre - a.centre;
    const double apart = between.norm() * radius_px_;
    const double lacking = a.radius_px + b.radius_px + gap_px - apart;
    if (lacking <= 0 || apart == 0) return true;
    const double push = lacking / (2 * apart);
    a.centre = (a.centre - push * between).normalized();
    b.centre = (b.centre + push * between).normalized();
    moved = true;
    return true;
  });
  return moved;
}

void SpherePlacement::spread(double gap_px) {
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    bool moved = false;
    for (std::size_t i = 0; i < caps_.size(); ++i) moved = push_apart(i, gap_px) || moved;
    if (!moved) break;
    for (auto& members : grid_) members.clear();
    for (std::size_t i = 0; i < caps_.size(); ++i) {
      grid_[cell(caps_[i].centre)].push_back(static_cast<int>(i));
    }
  }
}

}  // namespace impactdic::sim::speckle
