#include "host/impact/evidence/sparse_flights.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace impactdic::impact {
namespace {

constexpr std::size_t kFewestCentres = 4;
constexpr std::size_t kLongestGap = 3;    // frames between two centres of a flight
constexpr double kLeastBend = 2;          // px/frame^2: less is no film of this kind
constexpr double kOffPath = 0.1;          // of the bend: centres on the path lie so near
constexpr double kOffBlurred = 0.03;      // of a frame's way: or so near, for the ball is blurred
constexpr std::size_t kMostOff = 1;       // centres in a row that do not, which another then does
constexpr double kNear = 0.5;             // the same where no fit holds them there
constexpr double kBlurred = 0.15;         // of a frame's way: a blurred ball lies so near
constexpr double kSameBend = 0.15;        // by which the bends of two flights may differ
constexpr std::size_t kLongestLoss = 20;  // frames between two flights

// Height over time: height(t) = at + speed (t - from) + bend (t - from)^2 / 2.
struct Parabola {
  double from = 0, at = 0, speed = 0, bend = 0;
  double height(double t) const { return at + (t - from) * (speed + (t - from) * bend / 2); }
  double speed_at(double t) const { return speed + bend * (t - from); }
};

struct Arc {
  std::vector<std::size_t> rows;
  Parabola path;
};

// How near to the path a centre lies that is on it, px.
double near_path(const Parabola& path, double t) {
  return std::max(kOffPath * std::abs(path.bend), kOffBlurred * std::abs(path.speed_at(t)));
}

// Of rows by how near each lies to a path like `about`.
Parabola fit(const std::vector<double>& heights, const std::vector<std::size_t>& rows,
             const Parabola* about) {
  Parabola path;
  path.from = static_cast<double>(rows.front() + rows.back()) / 2;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const std::size_t row : rows) {
    const double t = static_cast<double>(row) - path.from;
    const double near = about == nullptr ? 1 : near_path(*about, static_cast<double>(row));
    const Eigen::Vector3d slopes = Eigen::Vector3d(1, t, t * t / 2) / near;
    normal += slopes * slopes.transpose();
    right += heights[row] / near * slopes;
  }
  const Eigen::Vector3d found = normal.ldlt().solve(right);
  path.at = found[0], path.speed = found[1], path.bend = found[2];
  return path;
}

Parabola fit(const std::vector<double>& heights, const std::vector<std::size_t>& rows) {
  const Parabola rough = fit(heights, rows, nullptr);
  return fit(heights, rows, &rough);
}

// Whether all centres lie on the path, and it bends enough, as gravity would have it.
bool holds(const Arc& arc, const std::vector<double>& heights) {
  if (!(arc.path.bend < -kLeastBend)) return false;
  return std::all_of(arc.rows.begin(), arc.rows.end(), [&](std::size_t row) {
    const auto t = static_cast<double>(row);
    return std::abs(heights[row] - arc.path.height(t)) <= near_path(arc.path, t);
  });
}

// The longest flight from the centre `seen[first]` on; empty where there is none. Centres that lie
// off it are left out.
Arc flight_from(const std::vector<std::size_t>& seen, std::size_t first,
                const std::vector<double>& heights) {
  Arc longest, arc;
  std::size_t off = 0;  // in a row
  for (std::size_t k = first; k < seen.size(); ++k) {
    // Three centres beside a gap lie on a parabola with any one behind it.
    const std::size_t gap = arc.rows.size() < kFewestCentres ? 1 : kLongestGap;
    if (!arc.rows.empty() && seen[k] - arc.rows.back() > gap) break;
    arc.rows.push_back(seen[k]);
    if (arc.rows.size() < kFewestCentres) continue;
    arc.path = fit(heights, arc.rows);
    if (holds(arc, heights)) {
      longest = arc;
      off = 0;
    } else if (longest.rows.empty() || ++off > kMostOff) {
      break;
    } else {
      arc = longest;
    }
  }
  return longest;
}

// The flights in order of time. Of those that share centres the longest is one.
std::vector<Arc> flights(const std::vector<double>& heights) {
  std::vector<std::size_t> seen;
  for (std::size_t i = 0; i < heights.size(); ++i) {
    if (std::isfinite(heights[i])) seen.push_back(i);
  }
  std::vector<Arc> found;
  for (std::size_t first = 0; first + kFewestCentres <= seen.size(); ++first) {
    Arc flight = flight_from(seen, first, heights);
    if (!flight.rows.empty()) found.push_back(std::move(flight));
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Arc& a, const Arc& b) { return a.rows.size() > b.rows.size(); });
  std::vector<Arc> arcs;
  std::vector<bool> taken(heights.size());
  for (Arc& flight : found) {
    const auto at = [&](std::size_t row) {
      return taken.begin() + static_cast<std::ptrdiff_t>(row);
    };
    const auto first = at(flight.rows.front()), end = at(flight.rows.back() + 1);
    if (std::find(first, end, true) != end) continue;
    std::fill(first, end, true);
    arcs.push_back(std::move(flight));
  }
  std::sort(arcs.begin(), arcs.end(),
            [](const Arc& a, const Arc& b) { return a.rows.front() < b.rows.front(); });
  return arcs;
}

// When the paths cross between the flights; nullopt where they do not, or not as a ball bounces.
std::optional<double> crossing(const Arc& before, const Arc& after) {
  const double first = static_cast<double>(before.rows.back());
  const double last = static_cast<double>(after.rows.front());
  if (last - first > static_cast<double>(kLongestLoss)) return std::nullopt;
  const double bend = (before.path.bend + after.path.bend) / 2;
  if (std::abs(before.path.bend - after.path.bend) > kSameBend * -bend) return std::nullopt;
  const auto apart = [&](double t) { return before.path.height(t) - after.path.height(t); };
  // Before the bounce the path of the flight after it lies below, after it above.
  double low = first, high = last;
  if (!(apart(low) > 0) || !(apart(high) < 0)) return std::nullopt;
  for (int round = 0; round < 50; ++round) {
    const double middle = (low + high) / 2;
    (apart(middle) > 0 ? low : high) = middle;
  }
  if (!(before.path.speed_at(low) < 0) || !(after.path.speed_at(low) > 0)) return std::nullopt;
  return low;
}

// Whether what is seen between the flights is a ball that goes on with the one and then is on the
// other: a hand or a string bends the path all the way. Of two centres one may be wrong.
bool flies_between(const std::vector<double>& heights, const Arc& before, const Arc& after,
                   double at) {
  int on = 0, off = 0;
  for (std::size_t i = before.rows.back() + 1; i < after.rows.front(); ++i) {
    if (!std::isfinite(heights[i])) continue;
    const double t = static_cast<double>(i);
    const Parabola& path = t < at ? before.path : after.path;
    const double near = std::max(kNear * -path.bend, kBlurred * std::abs(path.speed_at(t)));
    ++(std::abs(heights[i] - path.height(t)) <= near ? on : off);
  }
  return off <= on + 1;
}

}  // namespace

std::vector<SparseBounce> sparse_bounces(const ImpactSeries& series, double gravity_n) {
  if (!(gravity_n < 0)) return {};
  const std::vector<Arc> arcs = flights(series.position_n);
  std::vector<SparseBounce> bounces;
  for (std::size_t i = 0; i + 1 < arcs.size(); ++i) {
    const Arc &before = arcs[i], &after = arcs[i + 1];
    const std::optional<double> at = crossing(before, after);
    if (!at || !flies_between(series.position_n, before, after, *at)) continue;
    bounces.push_back({{before.rows.front(), before.rows.back(), *at},
                       {after.rows.front(), after.rows.back(), *at},
                       after.path.speed_at(*at) - before.path.speed_at(*at)});
  }
  std::stable_sort(
      bounces.begin(), bounces.end(),
      [](const SparseBounce& a, const SparseBounce& b) { return a.change > b.change; });
  return bounces;
}

}  // namespace impactdic::impact
