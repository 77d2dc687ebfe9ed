#include "host/pipeline/rows/doubt_motions.h"

#include <algorithm>
#include <cmath>

#include "host/pipeline/rows/path.h"

namespace impactdic::pipeline {
namespace {

// Deviations; of the motion, above which the circles are those of something else.
constexpr double kSlopeChance = 6, kMostSlowed = 0.1;
// The slope that steps of one px, each by chance, leave over n of them: this over n, squared.
constexpr double kOfSteps = 1.2;

// The circles less the motions up to them, along one axis: the same in all frames, but for errors.
struct Offsets {
  std::vector<double> off_px, weight;
};

Offsets offsets(std::span<const TrackRow> run, double TrackRow::*place, double TrackRow::*sd,
                double TrackRow::*move) {
  Offsets found;
  double moved_px = 0;
  for (const TrackRow& row : run) {
    const double known_px = std::max(row.*sd, kExact_px);
    found.off_px.push_back(row.*place - run.front().*place - moved_px);
    found.weight.push_back(1 / (known_px * known_px));
    moved_px += row.*move;
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
  return slope * slope > kSlopeChance * kSlopeChance * chance ? slope : 0;
}

}  // namespace

std::vector<bool> doubt_motions(std::span<const TrackRow> rows,
                                std::span<motion::PairMotion> pairs) {
  std::vector<bool> doubted(rows.size());
  for (std::size_t first = 0, end = 0; first < rows.size(); first = end) {
    end = first + 1;
    while (end < rows.size() && leads_on(rows[end - 1]) && rows[end].circle_ok) ++end;
    if (end - first <= kBeside || turns_in_space(rows[first])) continue;
    const auto run = rows.subspan(first, end - first);
    const Offsets along_x = offsets(run, &TrackRow::cx_px, &TrackRow::cx_sd_px, &TrackRow::dx_px);
    const Offsets along_y = offsets(run, &TrackRow::cy_px, &TrackRow::cy_sd_px, &TrackRow::dy_px);
    for (std::size_t i = 0; i + 1 < run.size(); ++i) {
      const double x_px = slope_about(along_x, i, run[i].dx_sd_px);
      const double y_px = slope_about(along_y, i, run[i].dy_sd_px);
      const double moved_px = std::hypot(run[i].dx_px, run[i].dy_px);
      if (!(std::hypot(x_px, y_px) < kMostSlowed * moved_px)) continue;
      dic::RigidMotion& motion = pairs[first + i].motion;
      motion.dx_sd_px = std::hypot(motion.dx_sd_px, x_px);
      motion.dy_sd_px = std::hypot(motion.dy_sd_px, y_px);
      doubted[first + i] = x_px != 0 || y_px != 0;
    }
  }
  return doubted;
}

}  // namespace impactdic::pipeline
