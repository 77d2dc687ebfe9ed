#include "host/pipeline/rows/compare_with_path.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/base/statistics.h"
#include "host/pipeline/rows/path.h"

namespace impactdic::pipeline {
namespace {

struct PlaceAlong {
  double at_px, variance_px2;
  bool is_that_of(const PlaceAlong& other) const {
    constexpr double kChance = 3;
    return std::abs(at_px - other.at_px) < kChance * std::sqrt(variance_px2 + other.variance_px2);
  }
};

// Where motions lead from the first of some rows that lead on, along one axis.
std::vector<PlaceAlong> ways(std::span<const TrackRow> run, const Axis& axis) {
  std::vector<PlaceAlong> found = {{0, 0}};
  for (const TrackRow& row : run.first(run.size() - 1)) {
    const double sd_px = row.*axis.move_sd;
    found.push_back(
        {found.back().at_px + row.*axis.move, found.back().variance_px2 + sd_px * sd_px});
  }
  return found;
}

// The motions of rows that lead on, whose last circle ends them.
bool leads_elsewhere(std::span<const TrackRow> run, const Axis& axis) {
  constexpr double kChance = 6, kLeast_px = 0.02;
  const PlaceAlong moved = ways(run, axis).back();
  const TrackRow &from = run.front(), &to = run.back();
  const double step_px = to.*axis.place - from.*axis.place;
  const double off_px = std::abs(moved.at_px - step_px) - kAboutCentre * std::abs(step_px);
  const double circles_px = std::hypot(from.*axis.place_sd, to.*axis.place_sd);
  return off_px > kLeast_px * static_cast<double>(run.size() - 1) &&
         off_px > kChance * std::sqrt(moved.variance_px2 + circles_px * circles_px);
}

// What rows `begin` to `end` say of where the ball is in row `of`, the motions between believed.
PlaceAlong told_by(std::span<const TrackRow> run, const std::vector<PlaceAlong>& way,
                   std::size_t begin, std::size_t end, std::size_t of, const Axis& axis) {
  constexpr double kOfMedian = 1.57;  // its variance over that of the mean
  std::vector<double> places, variances;
  for (std::size_t i = begin; i < end; ++i) {
    places.push_back(run[i].*axis.place + way[of].at_px - way[i].at_px);
    variances.push_back(std::pow(run[i].*axis.place_sd, 2));
  }
  const double count = static_cast<double>(end - begin);
  const double by_motions = std::abs(way[of].variance_px2 - way[(begin + end) / 2].variance_px2);
  return {median(std::move(places)), kOfMedian * median(std::move(variances)) / count + by_motions};
}

// Whether the circles on either side, led there by the motions, say of both circles of a row what
// these say themselves: a run of wrong circles is seen by those on one side alone, and motions that
// all err alike have the two sides differ.
bool is_borne_out(std::span<const TrackRow> run, std::size_t of, const Axis& axis) {
  const std::size_t before = std::min(of, kBeside), after = std::min(run.size() - of - 2, kBeside);
  if (before < kFewestOthers || after < kFewestOthers) return false;
  const std::vector<PlaceAlong> way = ways(run, axis);
  for (const std::size_t circle : {of, of + 1}) {
    const PlaceAlong one = told_by(run, way, of - before, of, circle, axis);
    const PlaceAlong other = told_by(run, way, of + 2, of + 2 + after, circle, axis);
    const PlaceAlong own = {run[circle].*axis.place, std::pow(run[circle].*axis.place_sd, 2)};
    if (!one.is_that_of(other) || !own.is_that_of(one) || !own.is_that_of(other)) return false;
  }
  return true;
}

// The rows about one, up to kBeside away, all of which lead on to the next.
bool is_borne_out(std::span<const TrackRow> rows, std::size_t of) {
  std::size_t first = of, last = of;  // whose circles count
  while (first > 0 && of - first < kBeside && leads_on(rows[first - 1])) --first;
  while (last + 1 < rows.size() && last - of <= kBeside && leads_on(rows[last])) ++last;
  if (!rows[last].circle_ok || last < of + 2) return false;
  const auto run = rows.subspan(first, last + 1 - first);
  return is_borne_out(run, of - first, kX) && is_borne_out(run, of - first, kY);
}

}  // namespace

void compare_with_path(std::span<TrackRow> rows) {
  constexpr std::size_t kFewest = 3, kMost = 8;
  std::vector<bool> wrong(rows.size());
  for (std::size_t first = 0; first < rows.size(); ++first) {
    std::size_t last = first;
    while (last + 1 < rows.size() && last < first + kMost && is_part_of_path(rows[last])) ++last;
    if (last < first + kFewest || !rows[last].circle_ok) continue;
    const auto run = rows.subspan(first, last + 1 - first);
    if (!leads_elsewhere(run, kX) && !leads_elsewhere(run, kY)) continue;
    for (std::size_t i = first; i < last; ++i) wrong[i] = true;
  }
  for (std::size_t i = 0; i < rows.size(); ++i) wrong[i] = wrong[i] && !is_borne_out(rows, i);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (wrong[i]) rows[i].status = TrackStatus::kInconsistent;
  }
}

}  // namespace impactdic::pipeline
