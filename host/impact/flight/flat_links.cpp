#include "host/impact/flight/flat_links.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

namespace impactdic::impact {
namespace {

// Of the place in frame `i`, so many frames after the flight's own, along one axis. `group`: of the
// rows that lean on the same keyframe.
Datum place(const ImpactSeries& series, const GravityDirection& direction, std::size_t i,
            double from, bool normal) {
  const BodyPose pose = series.pose(i);
  const auto [t, n] = series.local(pose.x_px, pose.y_px);
  const std::size_t column = normal ? kN0 : kT0;
  Datum row;
  row.kind = DatumKind::kShift;
  row.normal = normal;
  row.value = normal ? n : t;
  row.slope[column] = 1;
  row.slope[column + 1] = from;
  row.gravity_slope = (normal ? direction.n : direction.t) * from * from / 2;
  row.across_slope = (normal ? direction.t : -direction.n) * from * from / 2;
  row.offset_slope = turned_place(pose.angle_rad, normal);
  // Its noise is that of the step into it, of which two frames make one half each; the rest of what
  // it states is its keyframe's.
  row.sd = series.step_sd(i - 1) / std::sqrt(2.0);
  const double stated = std::hypot(pose.x_sd_px, pose.y_sd_px) / std::sqrt(2.0);
  row.loose = std::sqrt(std::max(std::pow(stated / row.sd, 2) - 1, 1.0));
  return row;
}

}  // namespace

std::vector<Datum> flat_links(const ImpactSeries& series, const GravityDirection& direction,
                              const FlightRange& range, int flight, int first_group) {
  std::vector<Datum> rows;
  std::map<std::pair<std::int64_t, std::int64_t>, int> groups;  // by origin and keyframe
  for (std::size_t i = range.first + 1; i <= range.last; ++i) {
    const BodyPose pose = series.pose(i);
    if (!pose.ok || !std::isfinite(pose.angle_rad) || !(series.step_sd(i - 1) > 0)) continue;
    const int next = first_group + 2 * static_cast<int>(groups.size());
    const int group = groups.try_emplace({pose.origin, pose.keyframe}, next).first->second;
    for (const bool normal : {false, true}) {
      Datum row = place(series, direction, i, static_cast<double>(i) - range.at, normal);
      row.flight = flight;
      row.group = group + (normal ? 1 : 0);
      rows.push_back(row);
    }
  }
  const auto frames = static_cast<double>(range.last - range.first);
  if (static_cast<double>(rows.size()) < 2 * kFewestLinked * frames) return {};
  return rows;
}

double followed_sd(const ImpactSeries& series, const FlightRange& range) {
  double largest = 0;
  std::int64_t origin = -1;
  for (std::size_t i = range.first + 1; i <= range.last; ++i) {
    const BodyPose pose = series.pose(i);
    if (!pose.ok || pose.origin == origin) continue;
    origin = pose.origin;
    const double sd = series.origin_sd(i);
    if (sd > largest) largest = sd;
  }
  return largest;
}

}  // namespace impactdic::impact
