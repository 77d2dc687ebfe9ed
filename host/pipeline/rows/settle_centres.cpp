#include "host/pipeline/rows/settle_centres.h"

#include <algorithm>
#include <cmath>

#include "host/base/statistics.h"
#include "host/pipeline/rows/compare_rows.h"
#include "host/pipeline/rows/place_by_path.h"

namespace impactdic::pipeline {
namespace {

// What a circle errs by is found from its own frame's residuals, which is known roughly: of those
// that state plainly less than the ones beside them most err as much. They state the geometric
// mean of both. A circle that somebody has looked at states what it does.
void state_as_others(std::span<TrackRow> run, double TrackRow::*sd, std::size_t first_row,
                     std::vector<bool>& changed) {
  constexpr std::size_t kOnEitherSide = 6;
  constexpr double kPlainlyLess = 0.8;
  std::vector<double> own;
  for (const TrackRow& row : run) own.push_back(row.*sd);
  for (std::size_t i = 0; i < run.size(); ++i) {
    const std::size_t first = i - std::min(i, kOnEitherSide);
    const std::size_t end = std::min(i + kOnEitherSide + 1, run.size());
    const auto at = [&](std::size_t k) { return own.begin() + static_cast<std::ptrdiff_t>(k); };
    const double usual = median({at(first), at(end)});
    if (run[i].by_hand != ByHand::kNo || !(own[i] < kPlainlyLess * usual)) continue;
    run[i].*sd = std::sqrt(own[i] * usual);
    changed[first_row + i] = true;
  }
}

void state_as_others(std::span<TrackRow> rows, std::vector<bool>& changed) {
  for (std::size_t first = 0, end = 0; first < rows.size(); first = end) {
    end = first + 1;
    if (!rows[first].circle_ok) continue;
    while (end < rows.size() && rows[end].circle_ok) ++end;
    for (double TrackRow::*sd : {&TrackRow::cx_sd_px, &TrackRow::cy_sd_px}) {
      state_as_others(rows.subspan(first, end - first), sd, first, changed);
    }
  }
}

// Which circles lie elsewhere on the body than those before them. `centre`: a copy.
std::vector<bool> lie_elsewhere(std::span<const TrackRow> rows, CentreOnBody centre) {
  std::vector<bool> elsewhere;
  for (const TrackRow& row : rows) elsewhere.push_back(centre.compare(row).elsewhere);
  return elsewhere;
}

}  // namespace

std::vector<bool> settle_centres(std::span<TrackRow> rows, std::span<motion::PairMotion> pairs,
                                 bool placed, const CentreOnBody& centre) {
  std::vector<bool> changed = state_scatter(rows);
  if (placed) {
    const std::vector<bool> by_path = place_by_path(rows, pairs, lie_elsewhere(rows, centre));
    for (std::size_t i = 0; i < rows.size(); ++i) changed[i] = changed[i] || by_path[i];
  }
  // Last: a path is led by circles that are known well, for whatever reason.
  state_as_others(rows, changed);
  return changed;
}

}  // namespace impactdic::pipeline
