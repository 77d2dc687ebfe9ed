#include "host/track/track_row.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/base/error.h"

namespace impactdic {

namespace {
constexpr std::array kWords = {"ok",          "no_ball",   "no_texture", "low_correlation",
                               "out_of_view", "last_frame"};
}  // namespace

const char* to_string(TrackStatus status) { return kWords[static_cast<std::size_t>(status)]; }

TrackStatus parse_track_status(const std::string& word) {
  for (std::size_t i = 0; i < kWords.size(); ++i) {
    if (word == kWords[i]) return static_cast<TrackStatus>(i);
  }
  throw InvalidArgument("'" + word + "' is not a status of a tracked frame");
}

void set_circle(TrackRow& row, const CircleFit& fit) {
  row.circle_ok = fit.status == CircleStatus::ok;
  row.status = fit.status == CircleStatus::ok            ? TrackStatus::ok
               : fit.status == CircleStatus::out_of_view ? TrackStatus::out_of_view
                                                         : TrackStatus::no_ball;
  if (!row.circle_ok) return;
  row.cx_px = fit.circle.cx_px;
  row.cy_px = fit.circle.cy_px;
  row.r_px = fit.circle.r_px;
  row.cx_sd_px = fit.cx_sd_px;
  row.cy_sd_px = fit.cy_sd_px;
  row.r_sd_px = fit.r_sd_px;
}

void set_motion(TrackRow& row, const RigidMotion& motion) {
  row.motion_ok = motion.ok;
  row.windows = motion.used;
  if (!motion.ok) return;
  row.dx_px = motion.dx_px;
  row.dy_px = motion.dy_px;
  row.rot_deg = motion.rot_rad * kDegPerRad;
  row.dx_sd_px = motion.dx_sd_px;
  row.dy_sd_px = motion.dy_sd_px;
  row.rot_sd_deg = motion.rot_sd_rad * kDegPerRad;
  // The point that was followed is off the ball's centre by the circle's error, and turns about it.
  if (!row.circle_ok) return;
  const double c = std::cos(motion.rot_rad) - 1, s = std::sin(motion.rot_rad);
  row.dx_sd_px = std::hypot(row.dx_sd_px, c * row.cx_sd_px, s * row.cy_sd_px);
  row.dy_sd_px = std::hypot(row.dy_sd_px, s * row.cx_sd_px, c * row.cy_sd_px);
}

SiRow to_si(const TrackRow& row, const SiScale& scale) {
  const double length = scale.metre_per_px > 0 ? scale.metre_per_px : kNotMeasured;
  const double rate = scale.fps > 0 ? scale.fps : kNotMeasured;
  const double speed = length * rate;
  const double c = std::cos(scale.surface_angle_rad), s = std::sin(scale.surface_angle_rad);
  SiRow si{};
  si.x_m = row.cx_px * length;
  si.y_m = (scale.image_height - 1 - row.cy_px) * length;
  si.vx_m_s = row.dx_px * speed;
  si.vy_m_s = -row.dy_px * speed;
  si.vt_m_s = c * si.vx_m_s + s * si.vy_m_s;
  si.vn_m_s = -s * si.vx_m_s + c * si.vy_m_s;
  si.omega_rad_s = row.rot_deg * kRadPerDeg * rate;
  si.vx_sd_m_s = row.dx_sd_px * speed;
  si.vy_sd_m_s = row.dy_sd_px * speed;
  si.omega_sd_rad_s = row.rot_sd_deg * kRadPerDeg * rate;
  return si;
}

std::optional<double> median_radius_px(const std::vector<TrackRow>& rows) {
  std::vector<double> radii;
  for (const TrackRow& row : rows) {
    if (row.circle_ok) radii.push_back(row.r_px);
  }
  if (radii.empty()) return std::nullopt;
  const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
  std::nth_element(radii.begin(), middle, radii.end());
  return *middle;
}

}  // namespace impactdic
