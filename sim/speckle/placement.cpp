#include "sim/speckle/placement.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>

namespace impactdic::sim::speckle {
namespace {

constexpr double kMargin = 24;  // of the grid beyond the ball, px

// Whether hypot(dx, dy) is beyond the distance, where rounding cannot matter; hypot is slow.
bool surely_beyond(double dx, double dy, double distance) {
  return distance <= 0 || dx * dx + dy * dy > distance * distance * (1 + 1e-9);
}

}  // namespace

Random::Random(std::uint64_t seed, std::uint64_t stream) {
  std::seed_seq both{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                     static_cast<std::uint32_t>(stream)};
  engine_.seed(both);
}

double Random::uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

double Random::normal() {
  const double u = 1 - uniform();
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * kPi * uniform());
}

Placement::Placement(double ball_radius_px)
    : radius_px_(ball_radius_px),
      gap_px_(kFirstGap),
      cells_(static_cast<int>(std::ceil(2 * (ball_radius_px + kMargin) / kCell)) + 1),
      grid_(static_cast<std::size_t>(cells_) * static_cast<std::size_t>(cells_)) {}

std::size_t Placement::cell(double x_px, double y_px) const {
  const auto index = [&](double at) {
    return std::clamp(static_cast<int>((at + radius_px_ + kMargin) / kCell), 0, cells_ - 1);
  };
  return static_cast<std::size_t>(index(y_px)) * static_cast<std::size_t>(cells_) +
         static_cast<std::size_t>(index(x_px));
}

template <typename Visit>
bool Placement::each_near(double x_px, double y_px, double near_px, const Visit& visit) const {
  const int reach = static_cast<int>(std::ceil(std::max(0.0, near_px) / kCell));
  const int home = static_cast<int>(cell(x_px, y_px)), row = home / cells_, column = home % cells_;
  for (int v = std::max(0, row - reach); v <= std::min(cells_ - 1, row + reach); ++v) {
    for (int u = std::max(0, column - reach); u <= std::min(cells_ - 1, column + reach); ++u) {
      for (const int other : grid_[static_cast<std::size_t>(v * cells_ + u)]) {
        if (!visit(static_cast<std::size_t>(other))) return false;
      }
    }
  }
  return true;
}

bool Placement::fits(const std::vector<InkDisc>& shape, double x_px, double y_px) const {
  for (const InkDisc& d : shape) {
    const double x = x_px + d.x_px, y = y_px + d.y_px;
    const bool free = each_near(x, y, d.radius_px + largest_px_ + gap_px_, [&](std::size_t other) {
      const InkDisc& o = discs_[other];
      const double apart = d.radius_px + o.radius_px + gap_px_;
      const double dx = x - o.x_px, dy = y - o.y_px;
      return apart <= 0 || surely_beyond(dx, dy, apart) || std::hypot(dx, dy) >= apart;
    });
    if (!free) return false;
  }
  return true;
}

void Placement::place(std::vector<InkDisc> shape, Random& random) {
  double size = 0, largest = 0;
  for (const InkDisc& d : shape) {
    size = std::max(size, std::hypot(d.x_px, d.y_px) + d.radius_px);
    largest = std::max(largest, d.radius_px);
  }
  const double reach = radius_px_ + 0.7 * size;
  double x, y;
  for (int tries = 1;; ++tries) {
    const double away = reach * std::sqrt(random.uniform()), angle = 2 * kPi * random.uniform();
    x = away * std::cos(angle);
    y = away * std::sin(angle);
    if (fits(shape, x, y)) break;
    if (tries % kTriesPerGap == 0) gap_px_ -= kGapStep;
  }
  for (InkDisc& d : shape) {
    d.x_px += x;
    d.y_px += y;
    grid_[cell(d.x_px, d.y_px)].push_back(static_cast<int>(discs_.size()));
    discs_.push_back(d);
  }
  largest_px_ = std::max(largest_px_, largest);
}

bool Placement::push_apart(std::size_t index, double gap_px) {
  bool moved = false;
  const InkDisc at = discs_[index];
  each_near(at.x_px, at.y_px, at.radius_px + largest_px_ + gap_px, [&](std::size_t other) {
    if (other == index) return true;
    InkDisc &a = discs_[index], &b = discs_[other];
    const double dx = b.x_px - a.x_px, dy = b.y_px - a.y_px;
    const double wanted = a.radius_px + b.radius_px + gap_px;
    if (surely_beyond(dx, dy, wanted)) return true;
    const double apart = std::hypot(dx, dy), lacking = wanted - apart;
    if (lacking <= 0 || apart == 0) return true;
    const double push = lacking / (2 * apart);
    a = {a.x_px - push * dx, a.y_px - push * dy, a.radius_px};
    b = {b.x_px + push * dx, b.y_px + push * dy, b.radius_px};
    moved = true;
    return true;
  });
  return moved;
}

void Placement::spread(double gap_px) {
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    bool moved = false;
    for (std::size_t i = 0; i < discs_.size(); ++i) moved = push_apart(i, gap_px) || moved;
    if (!moved) break;
    for (auto& members : grid_) members.clear();
    for (std::size_t i = 0; i < discs_.size(); ++i) {
      InkDisc& d = discs_[i];
      const double away = std::hypot(d.x_px, d.y_px), limit = radius_px_ + 0.7 * d.radius_px;
      if (away > limit) d = {d.x_px * limit / away, d.y_px * limit / away, d.radius_px};
      grid_[cell(d.x_px, d.y_px)].push_back(static_cast<int>(i));
    }
  }
}

}  // namespace impactdic::sim::speckle
