#include "host/run/track/rough_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "host/base/statistics.h"

namespace impactdic::run {
namespace {

constexpr std::size_t kFewestSteps = 16;
// How much more than chance, and how far: what forces do within three frames is less.
constexpr double kRoughSds = 10, kLeastRough_px = 0.02;

bool is_plain_step(const TrackRow& row) {
  return row.status == TrackStatus::kOk && row.motion_ok && row.periods == 1;
}

}  // namespace

std::string rough_path_warning(const TrackRows& rows) {
  std::array<TrackRow, 3> beside;
  std::vector<double> off, stated;
  for (const TrackRow& row : rows) {
    std::move(beside.begin() + 1, beside.end(), beside.begin());
    beside.back() = row;
    const auto& [a, b, c] = beside;
    if (!is_plain_step(a) || !is_plain_step(b) || !is_plain_step(c)) continue;
    // A step from the mean of those beside, with the variance of one.
    const double per = 1 / std::sqrt(1.5);
    const double x = b.dx_px - (a.dx_px + c.dx_px) / 2, y = b.dy_px - (a.dy_px + c.dy_px) / 2;
    off.push_back(per * std::hypot(x, y));
    stated.push_back(std::hypot(b.dx_sd_px, b.dy_sd_px));
  }
  if (off.size() < kFewestSteps) return "";
  const double far = median(off);
  if (far < std::max(kLeastRough_px, kRoughSds * median(stated))) return "";
  char text[320];
  std::snprintf(
      text, sizeof text,
      "the ball's steps differ from those beside by %.2f px, %.0f times what they state, and "
      "no flight was found: the camera shakes, or frames are not evenly spaced. Before a "
      "background with texture a camera's motion is measured and taken off",
      far, far / median(stated));
  return text;
}

}  // namespace impactdic::run
