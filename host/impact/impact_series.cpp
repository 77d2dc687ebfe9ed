#include "host/impact/impact_series.h"

#include <algorithm>
#include <cmath>

namespace impactdic::impact {
namespace {

constexpr double kSdOfMad = 1.4826;  // of a normal distribution
// A contact ends where the acceleration has fallen to this part of its peak for so many frames.
constexpr double kFaint = 0.03;
constexpr int kFaintFrames = 3;

double at(const std::vector<double>& v, std::ptrdiff_t i) {
  return i >= 0 && i < static_cast<std::ptrdiff_t>(v.size()) ? v[static_cast<std::size_t>(i)]
                                                             : kNotMeasured;
}

// Median of the steps within `reach`: a single bad frame does not show.
std::vector<double> smoothed(const std::vector<double>& steps, std::ptrdiff_t reach) {
  std::vector<double> result(steps.size(), kNotMeasured);
  for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(steps.size()); ++i) {
    std::vector<double> near;
    for (std::ptrdiff_t k = i - reach; k <= i + reach; ++k) near.push_back(at(steps, k));
    result[static_cast<std::size_t>(i)] = median_of(near);
  }
  return result;
}

double noise_of(const std::vector<double>& steps) {
  std::vector<double> bends;
  for (std::size_t i = 0; i + 2 < steps.size(); ++i) {
    bends.push_back(std::abs(steps[i] - 2 * steps[i + 1] + steps[i + 2]));
  }
  return kSdOfMad * median_of(bends) / std::sqrt(6.0);
}

// Acceleration about the instant between steps i - 1 and i, over `reach` steps on each side.
double acceleration(const std::vector<double>& v, std::ptrdiff_t i, std::ptrdiff_t reach) {
  return (at(v, i + reach - 1) - at(v, i - reach)) / static_cast<double>(2 * reach - 1);
}

}  // namespace

double median_of(std::vector<double> values) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  if (values.empty()) return kNotMeasured;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double common_share(double scatter, std::size_t count) {
  const double chance = 3 * std::sqrt(2 / static_cast<double>(count));
  return std::max(0.0, 1 - scatter * scatter - chance);
}

ImpactSeries impact_series(const std::vector<TrackRow>& rows, double surface_angle_rad) {
  const double c = std::cos(surface_angle_rad), s = std::sin(surface_angle_rad);
  ImpactSeries series;
  bool any_motion = false;
  for (const TrackRow& row : rows) {
    const bool circle = row.circle_ok, motion = row.motion_ok;
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

ContactGuess guess_contact(const ImpactSeries& series, double gravity_n) {
  ContactGuess guess;
  const std::vector<double> v = smoothed(series.step_n, 2);
  guess.step_noise = noise_of(series.step_n);
  const auto count = static_cast<std::ptrdiff_t>(v.size());
  // The sharpest turn from towards the surface to away from it.
  std::ptrdiff_t turn = -1;
  double sharpest = 0;
  for (std::ptrdiff_t i = 1; i < count; ++i) {
    if (!(at(v, i - 1) < 0) || !(at(v, i) >= 0)) continue;
    const double rise = acceleration(v, i, 3);
    if (rise > sharpest) sharpest = rise, turn = i;
  }
  if (turn < 0) return guess;
  guess.turn = static_cast<double>(turn);
  guess.peak_acceleration = sharpest - gravity_n;
  const double quiet =
      std::max(kFaint * guess.peak_acceleration, 2 * guess.step_noise / std::sqrt(5.0));
  if (guess.peak_acceleration < 2 * quiet) return guess;
  const auto edge = [&](std::ptrdiff_t direction) {
    int faint = 0;
    std::ptrdiff_t i = turn;
    for (; i > 0 && i < count && faint < kFaintFrames; i += direction) {
      faint = acceleration(v, i, 3) - gravity_n < quiet ? faint + 1 : 0;
    }
    return std::clamp<std::ptrdiff_t>(i - direction * faint, 0, count - 1);
  };
  guess.first = static_cast<std::size_t>(edge(-1));
  guess.last = static_cast<std::size_t>(edge(1));
  guess.found = true;
  return guess;
}

}  // namespace impactdic::impact
