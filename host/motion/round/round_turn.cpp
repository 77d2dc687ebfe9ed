#include "host/motion/round/round_turn.h"

#include <impactdic/units.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "host/dic/sphere/rotation.h"
#include "host/motion/estimators.h"

namespace impactdic::motion {
namespace {

using Turn = Eigen::Quaterniond;

// Turns that are made exact, and the steps that lead there: the search's are good to a degree or
// two. The last step is a tenth of what the deviations are.
constexpr std::size_t kCandidates = 12;
constexpr double kSteps_deg[] = {3, 1.5, 0.75, 0.4, 0.2, 0.1, 0.05};
// Points every so many pixels across and down: texture of a thirtieth of a radius of some 100 px is
// 3 px fine.
constexpr int kEvery_px = 2;
// Where the surface is seen more from the side, cosine, its texture is too foreshortened and the
// model's depth too far off.
constexpr double kLeastDepth = 0.25;
// Share of the points of one view that the other must show, too.
constexpr double kLeastShown = 0.15;
// Of ZNCC times the root of the share of points that both views show. The 27 pairs of neighbouring
// views of two fruits have 0.51 to 0.78, 68 pairs that are five or six views apart up to 0.47.
// [measured]
constexpr double kLeastScore = 0.49;
// Side of the squares, share of the radius, whose errors are their own: beyond what the views'
// surroundings reach.
constexpr double kBlock = 0.25;
constexpr double kMeanDepth = 2.0 / 3;  // of the visible half, of the radius

RoundView less(const RoundView& view, const RoundView& light) {
  RoundView rest = view;
  for (std::size_t i = 0; i < rest.size() && light.size() > 0; ++i) {
    if (rest.data()[i] != 0) rest.data()[i] -= light.data()[i];
  }
  return rest;
}

// A view between its pixels: value, slopes a px, and whether all four pixels show the body.
struct Sample {
  bool ok = false;
  double value = 0, along_x = 0, along_y = 0;
};

Sample sample(const RoundView& view, double x, double y) {
  const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
  if (x0 < 0 || y0 < 0 || x0 + 1 >= view.width() || y0 + 1 >= view.height()) return {};
  const float* upper = view.row(y0) + x0;
  const float* lower = view.row(y0 + 1) + x0;
  if (upper[0] == 0 || upper[1] == 0 || lower[0] == 0 || lower[1] == 0) return {};
  const double a = double(upper[0]), b = double(upper[1]);
  const double c = double(lower[0]), d = double(lower[1]), s = x - x0, t = y - y0;
  return {true, std::lerp(std::lerp(a, b, s), std::lerp(c, d, s), t), std::lerp(b - a, d - c, t),
          std::lerp(c - a, d - b, s)};
}

// Both views of one surface.
class Pair {
 public:
  Pair(const RoundFrame& round, const RoundView& first, const RoundView& second)
      : round_(round), second_(second) {
    for (int y = 0; y < first.height(); y += kEvery_px) {
      for (int x = 0; x < first.width(); x += kEvery_px) {
        const double u = (x - round.centre_px()) / round.radius_px;
        const double v = (round.centre_px() - y) / round.radius_px;
        const double depth2 = 1 - u * u - v * v;
        if (first(x, y) == 0 || depth2 < kLeastDepth * kLeastDepth) continue;
        points_.push_back({{u, v, std::sqrt(depth2)}, double(first(x, y))});
      }
    }
  }

  // ZNCC of what both show under the turn; -1 where that is too little. `share`, where given: of
  // the points of the first view, what the second one shows.
  double agreement(const Turn& turn, double* share = nullptr) const {
    const Eigen::Matrix3d matrix = turn.toRotationMatrix();
    Sums sums;
    int shown = 0;
    for (const Point& point : points_) {
      const Eigen::Vector3d to = matrix * point.place;
      if (to.z() < kLeastDepth) continue;
      const Sample seen = at(to);
      if (!seen.ok) continue;
      sums.add(weight(point, to), point.value, seen.value);
      ++shown;
    }
    const double of_all = shown / static_cast<double>(points_.size());
    if (share != nullptr) *share = of_all;
    return of_all < kLeastShown ? -1 : sums.correlation();
  }

  // Few points that agree by chance do not count for as much as many.
  double score(const Turn& turn) const {
    double share = 0;
    const double correlation = agreement(turn, &share);
    return correlation * std::sqrt(share);
  }

  // Covariance of small turns about X, Y and Z after `turn`, by the scores of blocks of the
  // surface (Liang and Zeger 1986), so that what a block has wrong as a whole counts.
  Eigen::Matrix3d covariance(const Turn& turn) const {
    const Eigen::Matrix3d matrix = turn.toRotationMatrix();
    Sums sums;
    struct Row {
      std::pair<int, int> block;
      double weight, first, second;
      Eigen::Vector3d slope;
    };
    std::vector<Row> rows;
    for (const Point& point : points_) {
      const Eigen::Vector3d to = matrix * point.place;
      if (to.z() < kLeastDepth) continue;
      const Sample seen = at(to);
      if (!seen.ok) continue;
      const double w = weight(point, to), gx = seen.along_x, gy = -seen.along_y;  // Y is up
      sums.add(w, point.value, seen.value);
      rows.push_back({{static_cast<int>(std::floor(point.place.x() / kBlock)),
                       static_cast<int>(std::floor(point.place.y() / kBlock))},
                      w,
                      point.value,
                      seen.value,
                      round_.radius_px *
                          Eigen::Vector3d(-gy * to.z(), gx * to.z(), gy * to.x() - gx * to.y())});
    }
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero(), scores = Eigen::Matrix3d::Zero();
    std::map<std::pair<int, int>, Eigen::Vector3d> blocks;
    for (const Row& row : rows) {
      const double residual =
          row.second - sums.g / sums.n - sums.gain() * (row.first - sums.f / sums.n);
      normal += row.weight * row.slope * row.slope.transpose();
      blocks.try_emplace(row.block, Eigen::Vector3d::Zero()).first->second +=
          row.weight * residual * row.slope;
    }
    for (const auto& [place, score] : blocks) scores += score * score.transpose();
    const Eigen::Matrix3d inverse = normal.inverse();
    return inverse * scores * inverse;
  }

 private:
  struct Point {
    Eigen::Vector3d place;  // on the unit sphere, camera axes
    double value = 0;
  };
  // Of values f and g under weights.
  struct Sums {
    double n = 0, f = 0, g = 0, ff = 0, gg = 0, fg = 0;
    void add(double w, double first, double second) {
      n += w;
      f += w * first;
      g += w * second;
      ff += w * first * first;
      gg += w * second * second;
      fg += w * first * second;
    }
    double correlation() const {
      const double spread = (ff - f * f / n) * (gg - g * g / n);
      return spread > 0 ? (fg - f * g / n) / std::sqrt(spread) : -1;
    }
    double gain() const { return (fg - f * g / n) / (ff - f * f / n); }
  };

  static double weight(const Point& point, const Eigen::Vector3d& to) {
    return std::min(point.place.z(), to.z());
  }
  Sample at(const Eigen::Vector3d& to) const {
    return sample(second_, round_.centre_px() + round_.radius_px * to.x(),
                  round_.centre_px() - round_.radius_px * to.y());
  }

  RoundFrame round_;
  const RoundView& second_;
  std::vector<Point> points_;
};

// The turn near `turn` under which the views agree best.
Turn climb(const Pair& pair, Turn turn) {
  double best = pair.agreement(turn);
  for (const double step_deg : kSteps_deg) {
    for (bool better = true; better;) {
      better = false;
      for (int k = 0; k < 6; ++k) {
        Eigen::Vector3d by = Eigen::Vector3d::Zero();
        by[k / 2] = (k % 2 == 0 ? 1 : -1) * step_deg * kRadPerDeg;
        const Turn next = dic::quaternion_of(by) * turn;
        const double agreement = pair.agreement(next);
        if (agreement <= best) continue;
        best = agreement;
        turn = next;
        better = true;
      }
    }
  }
  return turn;
}

}  // namespace

RoundTurn::RoundTurn(opencl::Engine& engine, const RoundFrame& round)
    : round_(round), frames_(engine, 2), search_(engine) {}

dic::RigidMotion RoundTurn::measure(const RoundView& first, const RoundView& second,
                                    const RoundView& light, const Doubt& doubt) {
  const RoundView before = less(first, light), after = less(second, light);
  frames_.set(0, as_frame(before));
  frames_.set(1, as_frame(after));
  PairMotion task;
  task.second_slot = 1;
  task.first = task.second = {round_.centre_px(), round_.centre_px(), round_.radius_px};
  const Pair pair(round_, before, after);
  double best = -1;
  Turn turn = Turn::Identity();
  for (const dic::SphereTurn& candidate :
       search_.find(frames_, search_task(task, round_.radius_px), kCandidates)) {
    const Turn led = climb(pair, Turn(candidate.w, candidate.x, candidate.y, candidate.z));
    const double score = pair.score(led);
    if (score <= best) continue;
    best = score;
    turn = led;
  }
  dic::RigidMotion motion;
  if (best < kLeastScore) return motion;
  const Eigen::Vector3d vector = dic::rotation_vector(turn);
  const Eigen::Matrix3d covariance = pair.covariance(turn);
  const double by_centres = std::sqrt(2.0) * doubt.centre_sd_px / (kMeanDepth * round_.radius_px);
  const double by_shape = doubt.depth_sd * std::hypot(vector.x(), vector.y());
  motion.ok = true;
  motion.rot_x_rad = vector.x();
  motion.rot_y_rad = vector.y();
  motion.rot_rad = vector.z();
  motion.rot_x_sd_rad = std::hypot(std::sqrt(covariance(0, 0)), by_centres, by_shape);
  motion.rot_y_sd_rad = std::hypot(std::sqrt(covariance(1, 1)), by_centres, by_shape);
  motion.rot_sd_rad = std::hypot(std::sqrt(covariance(2, 2)), by_shape);
  return motion;
}

}  // namespace impactdic::motion
