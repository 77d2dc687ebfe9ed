#include "host/pipeline/rows/doubt_motions.h"

#include <algorithm>
#include <cmath>

#include "host/pipeline/rows/path.h"

namespace impactdic::pipeline {
namespace {

// Deviations that chance does not reach.
constexpr double kDoubtChance = 6;
// Share of the motion above which the circles are those of something else.
constexpr double kMostSlowed = 0.1;
// The variance of the slope over n steps that each err by one px: this over n.
constexpr double kOfSteps = 1.2;

// By how much a motion is not the way between its two circles, where that is beyond chance.
double off_alone(const TrackRow& row, const TrackRow& next, const Axis& axis) {
  const double off_px = next.*axis.place - row.*axis.place - row.*axis.move;
  const double sd_px = std::hypot(next.*axis.place_sd, row.*axis.place_sd, row.*axis.move_sd);
  return std::abs(off_px) > kDoubtChance * sd_px ? off_px : 0;
}

// The circles less the motions up to them, along one axis: the same in all frames, but for errors.
struct Offsets {
  std::vector<double> alone_px;  // of each motion; it does not count in those behind it
  std::vector<double> off_px, weight;
};

Offsets offsets(std::span<const TrackRow> run, const Axis& axis) {
  Offsets found;
  double moved_px = 0;
  for (std::size_t i = 0; i < run.size(); ++i) {
    const double known_px = std::max(run[i].*axis.place_sd, kExact_px);
    found.off_px.push_back(run[i].*axis.place - run[0].*axis.place - moved_px);
    found.weight.push_back(1 / (known_px * known_px));
    if (i + 1 == run.size()) break;
    found.alone_px.push_back(off_alone(run[i], run[i + 1], axis));
    moved_px += run[i].*axis.move + found.alone_px[i];
  }
  return found;
}

// The slope about frame `of`, px a frame, where it is beyond chance; 0 otherwise. `step_sd_px`: of
// a motion.
double slope_about(const Offsets& offsets, std::size_t of, double step_sd_px) {
  const std::size_t begin = of > kBeside ? of - kBeside : 0;
  const std::size_t end = std::min(of + kBeside + 1, offsets.off_px.size());
  if (end - begin <= kBeside) return 0;
  double w = 0, t = 0, x = 0, tt = 0, tx = 0, xx = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const double weight = offsets.weight[i], off_px = offsets.off_px[i];
    const double step = static_cast<double>(i) - static_cast<double>(of);
    w += weight, t += weight * step, x += weight * off_px;
    tt += weight * step * step, tx += weight * step * off_px, xx += weight * off_px * off_px;
  }
  const double spread = tt - t * t / w, along = tx - t * x / w, slope = along / spread;
  const double scatter = (xx - x * x / w - slope * along) / static_cast<double>(end - begin - 2);
  const double by_steps = kOfSteps / static_cast<double>(end - begin) * step_sd_px * step_sd_px;
  const double chance = std::max(1.0, scatter) / spread + by_steps;
  return slope * slope > kDoubtChance * kDoubtChance * chance ? slope : 0;
}

// Of a contradiction a circle is as likely to be the cause.
double of_motion(double alone_px) { return std::abs(alone_px) < kContradiction_px ? alone_px : 0; }

void doubt(double by_px, double& sd_px, std::vector<bool>::reference doubted) {
  sd_px = std::hypot(sd_px, by_px);
  doubted = doubted || by_px != 0;
}

}  // namespace

std::vector<bool> doubt_motions(std::span<const TrackRow> rows,
                                std::span<motion::PairMotion> pairs) {
  std::vector<bool> doubted(rows.size());
  for (std::size_t first = 0, end = 0; first < rows.size(); first = end) {
    end = first + 1;
    while (end < rows.size() && leads_on(rows[end - 1]) && rows[end].circle_ok) ++end;
    if (turns_in_space(rows[first])) continue;
    const auto run = rows.subspan(first, end - first);
    const Offsets along_x = offsets(run, kX), along_y = offsets(run, kY);
    for (std::size_t i = 0; i + 1 < run.size(); ++i) {
      dic::RigidMotion& motion = pairs[first + i].motion;
      doubt(of_motion(along_x.alone_px[i]), motion.dx_sd_px, doubted[first + i]);
      doubt(of_motion(along_y.alone_px[i]), motion.dy_sd_px, doubted[first + i]);
      const double x_px = slope_about(along_x, i, run[i].dx_sd_px);
      const double y_px = slope_about(along_y, i, run[i].dy_sd_px);
      const double moved_px = std::hypot(run[i].dx_px, run[i].dy_px);
      if (!(std::hypot(x_px, y_px) < kMostSlowed * moved_px)) continue;
      doubt(x_px, motion.dx_sd_px, doubted[first + i]);
      doubt(y_px, motion.dy_sd_px, doubted[first + i]);
    }
  }
  return doubted;
}

}  // namespace impactdic::pipeline
