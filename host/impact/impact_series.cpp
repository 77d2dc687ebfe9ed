#include "host/impact/impact_series.h"

#include <algorithm>
#include <cmath>

namespace impactdic::impact {

double common_share(double scatter, std::size_t count) {
  const double chance = 3 * std::sqrt(2 / static_cast<double>(count));
  return std::max(0.0, 1 - scatter * scatter - chance);
}

ImpactSeries impact_series(const std::vector<TrackRow>& rows, double surface_angle_rad) {
  const double c = std::cos(surface_angle_rad), s = std::sin(surface_angle_rad);
  ImpactSeries series;
  bool any_motion = false;
  for (const TrackRow& row : rows) {
    const bool circle = row.circle_ok;
    const bool motion = row.motion_ok && row.status != TrackStatus::kInconsistent;
    any_motion |= motion;
    // Image axes have y down.
    series.position_t.push_back(circle ? c * row.cx_px - s * row.cy_px : kNotMeasured);
    series.position_n.push_back(circle ? -s * row.cx_px - c * row.cy_px : kNotMeasured);
    series.position_sd.push_back(std::hypot(row.cx_sd_px, row.cy_sd_px) / std::sqrt(2.0));
    series.step_t.push_back(motion ? c * row.dx_px - s * row.dy_px : kNotMeasured);
    series.step_n.push_back(motion ? -s * row.dx_px - c * row.dy_px : kNotMeasured);
    series.step_sd.push_back(std::hypot(row.dx_sd_px, row.dy_sd_px) / std::sqrt(2.0));
    series.turn.push_back(motion ? row.rot_deg * kRadPerDeg : kNotMeasured);
    series.turn_sd.push_back(row.rot_sd_deg * kRadPerDeg);
  }
  series.from_circle = !any_motion;
  if (!any_motion) {
    for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
      series.step_t[i] = series.position_t[i + 1] - series.position_t[i];
      series.step_n[i] = series.position_n[i + 1] - series.position_n[i];
      series.step_sd[i] = std::hypot(series.position_sd[i], series.position_sd[i + 1]);
    }
  }
  return series;
}

}  // namespace impactdic::impact
