#include "host/camera/calibrate/dot_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <optional>
#include <utility>

namespace impactdic::camera {
namespace {

using Eigen::Vector2d;

constexpr double kOffGrid = 0.25;     // of a step
constexpr double kLeastSine = 0.5;    // between the two axes
constexpr double kMostStretched = 3;  // of the axes' lengths
constexpr int kFewestLines = 3;
constexpr std::size_t kMostStarts = 12;

using Cell = std::pair<int, int>;  // column, row
using Lattice = std::map<Cell, std::size_t>;

struct Node {
  Cell cell;
  Vector2d along, down;  // to the next dot of the row, of the column
};

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

std::size_t nearest_to(const std::vector<Vector2d>& centres, const Vector2d& place) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < centres.size(); ++i) {
    if ((centres[i] - place).squaredNorm() < (centres[best] - place).squaredNorm()) best = i;
  }
  return best;
}

// Steps from a dot to its nearest neighbour and to the nearest one that lies across.
std::optional<Node> axes_at(const std::vector<Vector2d>& centres, std::size_t start) {
  std::vector<Vector2d> steps;
  for (std::size_t i = 0; i < centres.size(); ++i) {
    if (i != start) steps.push_back(centres[i] - centres[start]);
  }
  std::sort(steps.begin(), steps.end(),
            [](const Vector2d& a, const Vector2d& b) { return a.squaredNorm() < b.squaredNorm(); });
  for (const Vector2d& step : steps) {
    if (step.norm() > kMostStretched * steps[0].norm()) break;
    if (std::abs(cross(steps[0], step)) < kLeastSine * steps[0].norm() * step.norm()) continue;
    // Where the dot across is not seen this one leads aslant: by whole steps of the row.
    const Vector2d& along = steps[0];
    const Vector2d across = step - std::round(step.dot(along) / along.squaredNorm()) * along;
    return Node{{0, 0}, along, cross(along, across) > 0 ? across : Vector2d(-across)};
  }
  return {};
}

Lattice grown(const std::vector<Vector2d>& centres, std::size_t start) {
  Lattice lattice;
  const std::optional<Node> first = axes_at(centres, start);
  if (!first) return lattice;
  std::vector<char> taken(centres.size(), 0);
  std::deque<Node> open = {*first};
  lattice[{0, 0}] = start;
  taken[start] = 1;
  while (!open.empty()) {
    const Node node = open.front();
    open.pop_front();
    const Vector2d& from = centres[lattice.at(node.cell)];
    for (const auto& [column, row] : {Cell{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const Cell cell{node.cell.first + column, node.cell.second + row};
      if (lattice.contains(cell)) continue;
      const Vector2d step = column * node.along + row * node.down;
      const std::size_t found = nearest_to(centres, from + step);
      if (taken[found] || (centres[found] - from - step).norm() > kOffGrid * step.norm()) continue;
      lattice[cell] = found;
      taken[found] = 1;
      const Vector2d made = (column + row) * (centres[found] - from);
      open.push_back({cell, column != 0 ? made : node.along, row != 0 ? made : node.down});
    }
  }
  return lattice;
}

// The lattice turned by a quarter.
Lattice turned(const Lattice& lattice) {
  Lattice other;
  for (const auto& [cell, centre] : lattice) other[{cell.second, -cell.first}] = centre;
  return other;
}

struct Extent {
  int left, right, top, below;
  bool fits(int columns, int rows) const {
    return right - left < columns && below - top < rows && right - left + 1 >= kFewestLines &&
           below - top + 1 >= kFewestLines;
  }
};

Extent extent_of(const Lattice& lattice) {
  const Cell& first = lattice.begin()->first;
  Extent extent{first.first, first.first, first.second, first.second};
  for (const auto& [cell, centre] : lattice) {
    extent.left = std::min(extent.left, cell.first);
    extent.right = std::max(extent.right, cell.first);
    extent.top = std::min(extent.top, cell.second);
    extent.below = std::max(extent.below, cell.second);
  }
  return extent;
}

// Without the outermost lines that hold one dot alone: what lies beside the target, most times.
Lattice without_lone(Lattice lattice) {
  for (bool changed = true; changed && !lattice.empty();) {
    changed = false;
    const Extent extent = extent_of(lattice);
    const auto on_line = [&](int line, bool column) {
      return [=](const auto& one) { return (column ? one.first.first : one.first.second) == line; };
    };
    for (const auto& [line, column] : {std::pair{extent.left, true},
                                       {extent.right, true},
                                       {extent.top, false},
                                       {extent.below, false}}) {
      const auto is_on = on_line(line, column);
      if (std::count_if(lattice.begin(), lattice.end(), is_on) != 1) continue;
      std::erase_if(lattice, is_on);
      changed = true;
    }
  }
  return lattice;
}

// How far to the right a row leads in the picture, all steps of it together.
double leads_right(const Lattice& lattice, const std::vector<Vector2d>& centres) {
  double sum = 0;
  for (const auto& [cell, centre] : lattice) {
    const auto next = lattice.find({cell.first + 1, cell.second});
    if (next != lattice.end()) sum += centres[next->second].x() - centres[centre].x();
  }
  return sum;
}

}  // namespace

std::vector<Sighting> number_dots(const std::vector<Vector2d>& centres, int columns, int rows) {
  if (centres.size() < static_cast<std::size_t>(kFewestLines * kFewestLines)) return {};
  Lattice best;
  // Any start on the grid finds all of it; one beside it finds little.
  const std::size_t every = std::max<std::size_t>(1, centres.size() / kMostStarts);
  for (std::size_t start = 0; start < centres.size(); start += every) {
    Lattice one = grown(centres, start);
    if (one.size() > best.size()) best = std::move(one);
    if (2 * best.size() > centres.size()) break;
  }
  best = without_lone(std::move(best));
  if (best.empty()) return {};
  std::optional<Lattice> chosen;
  for (int quarter = 0; quarter < 4; ++quarter) {
    best = turned(best);
    if (!extent_of(best).fits(columns, rows)) continue;
    if (!chosen || leads_right(best, centres) > leads_right(*chosen, centres)) chosen = best;
  }
  if (!chosen) return {};
  const Extent extent = extent_of(*chosen);
  std::vector<Sighting> seen;
  for (const auto& [cell, centre] : *chosen) {
    const int point = (cell.second - extent.top) * columns + cell.first - extent.left;
    seen.push_back({static_cast<std::size_t>(point), centres[centre]});
  }
  std::sort(seen.begin(), seen.end(),
            [](const Sighting& a, const Sighting& b) { return a.point < b.point; });
  return seen;
}

}  // namespace impactdic::camera
