#include "sim/contact/derivatives/path_slopes.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cmath>

#include "sim/contact/derivatives/sensitive_run.h"
#include "sim/contact/shell/shell.h"

namespace impactdic::sim::contact {
namespace {

// Of a slope that says where to go a few digits will do.
constexpr double kSlopeTolerance = 1e-8;
// Two runs of one motion agree to this part of the way.
constexpr double kSameMotion = 1e-6;

bool finite(const Sensitive& number) { return number.v.allFinite(); }

// Gives the number of each key a derivative of its own. False where there is no such number.
bool seed_keys(const ImpactJob& job, std::span<const std::string> keys,
               JobNumbers<Sensitive>& numbers) {
  const std::vector<NumberOfJob<Sensitive>> inputs = numbers_of(job, numbers);
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const auto found = std::find_if(inputs.begin(), inputs.end(),
                                    [&](const auto& input) { return input.key == keys[k]; });
    if (found == inputs.end()) return false;
    found->number->v[static_cast<Eigen::Index>(k)] = 1;
  }
  return true;
}

// The run may have taken another branch at a fork.
bool same_motion(std::span<const SensitiveRun::State> followed,
                 std::span<const TrajectoryPoint> path) {
  if (followed.size() != path.size()) return false;
  double way = 0;
  for (const TrajectoryPoint& p : path) {
    way = std::max({way, std::abs(p.state.qt_m), std::abs(p.state.qn_m)});
  }
  for (std::size_t i = 0; i < path.size(); ++i) {
    const BodyState& plain = path[i].state;
    const double off = std::hypot(followed[i][kQt].a - plain.qt_m, followed[i][kQn].a - plain.qn_m);
    if (!(off <= kSameMotion * way)) return false;
  }
  return true;
}

// Fills the columns of these keys, the first of which is `first`. False where there are none.
bool fill_columns(const ImpactJob& job, std::span<const double> times_s,
                  std::span<const std::string> keys, std::size_t first,
                  std::span<const TrajectoryPoint> path, PathSlopes& slopes) {
  JobNumbers<Sensitive> numbers(job);
  if (!seed_keys(job, keys, numbers)) return false;
  SensitiveRun run(job, numbers, times_s);
  try {
    run.run();
  } catch (const Error&) {
    return false;
  }
  if (!run.separated() || !same_motion(run.path(), path)) return false;
  const Shell<Sensitive> shell(numbers);
  const std::size_t columns = slopes.t.size() / times_s.size();
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    const SensitiveRun::State& x = run.path()[i];
    const Sensitive outline = x[kQn] - (shell.given() ? shell.lag(x[kFlat]) : Sensitive(0));
    if (!finite(x[kQt]) || !finite(outline) || !finite(x[kAngle])) return false;
    for (std::size_t k = 0; k < keys.size(); ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      const std::size_t to = i * columns + first + k;
      slopes.t[to] = x[kQt].v[at], slopes.n[to] = outline.v[at], slopes.angle[to] = x[kAngle].v[at];
    }
  }
  return true;
}

}  // namespace

std::optional<PathSlopes> path_slopes(const ImpactJob& job, std::span<const double> times_s,
                                      std::span<const std::string> keys,
                                      std::span<const TrajectoryPoint> path) {
  if (job.other) return std::nullopt;
  ImpactJob followed = job;
  followed.solver.relative_tolerance = std::max(job.solver.relative_tolerance, kSlopeTolerance);
  PathSlopes slopes;
  slopes.t.resize(times_s.size() * keys.size());
  slopes.n = slopes.angle = slopes.t;
  for (std::size_t first = 0; first < keys.size(); first += kInputsAtOnce) {
    const auto some =
        keys.subspan(first, std::min<std::size_t>(kInputsAtOnce, keys.size() - first));
    if (!fill_columns(followed, times_s, some, first, path, slopes)) return std::nullopt;
  }
  return slopes;
}

}  // namespace impactdic::sim::contact
