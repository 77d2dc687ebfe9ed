#include "host/clip/track_row.h"

#include <impactdic/error.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/base/statistics.h"
#include "host/clip/steady_rows.h"

namespace impactdic {

namespace {
constexpr std::array kWords = {"ok",          "no_ball",    "no_texture",   "low_correlation",
                               "out_of_view", "last_frame", "inconsistent", "repeated"};
constexpr std::array kBodies = {"auto", "sphere", "disc", "spheroid"};
constexpr std::size_t kAsked = 3;  // of them, by a person
}  // namespace

const char* to_string(Body body) { return kBodies[static_cast<std::size_t>(body)]; }

Body parse_body(const std::string& name) {
  for (std::size_t i = 0; i < kAsked; ++i) {
    if (name == kBodies[i]) return static_cast<Body>(i);
  }
  throw InvalidArgument("'" + name + "' is no body", "--body", "there are auto, sphere and disc");
}

const char* to_string(CameraMotionUse use) {
  return use == CameraMotionUse::kCorrect ? "correct" : "ignore";
}

CameraMotionUse parse_camera_motion(const std::string& name) {
  for (const CameraMotionUse use : {CameraMotionUse::kCorrect, CameraMotionUse::kIgnore}) {
    if (name == to_string(use)) return use;
  }
  throw InvalidArgument("'" + name + "' is nothing to do", "--camera-motion",
                        "there are correct and ignore");
}

const char* to_string(TrackStatus status) { return kWords[static_cast<std::size_t>(status)]; }

TrackStatus parse_track_status(const std::string& word) {
  for (std::size_t i = 0; i < kWords.size(); ++i) {
    if (word == kWords[i]) return static_cast<TrackStatus>(i);
  }
  throw InvalidArgument("'" + word + "' is not a status of a tracked frame");
}

SiRow to_si(const TrackRow& row, const SiScale& scale) {
  const double length = scale.metre_per_px > 0 ? scale.metre_per_px : kNotMeasured;
  // Of the motion to the next frame that there is.
  const double rate = scale.fps > 0 ? scale.fps / row.periods : kNotMeasured;
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
  // Relative: of scale and rate, the same in every row.
  const double rate_sd = scale.fps_sd / scale.fps;
  const double speed_sd = std::hypot(scale.metre_per_px_sd / length, rate_sd);
  si.vx_sd_m_s = std::hypot(row.dx_sd_px * speed, si.vx_m_s * speed_sd);
  si.vy_sd_m_s = std::hypot(row.dy_sd_px * speed, si.vy_m_s * speed_sd);
  si.omega_sd_rad_s = std::hypot(row.rot_sd_deg * kRadPerDeg * rate, si.omega_rad_s * rate_sd);
  const double turn = kRadPerDeg * rate;
  si.omega_t_rad_s = (c * row.rot_x_deg + s * row.rot_y_deg) * turn;
  si.omega_n_rad_s = (-s * row.rot_x_deg + c * row.rot_y_deg) * turn;
  si.omega_t_sd_rad_s = std::hypot(std::hypot(c * row.rot_x_sd_deg, s * row.rot_y_sd_deg) * turn,
                                   si.omega_t_rad_s * rate_sd);
  si.omega_n_sd_rad_s = std::hypot(std::hypot(s * row.rot_x_sd_deg, c * row.rot_y_sd_deg) * turn,
                                   si.omega_n_rad_s * rate_sd);
  return si;
}

namespace {

// A free flight's velocity towards the camera is that of each of its rows.
void add_depth(const ImpactFigures& figures, std::int64_t frame, SiRow& si) {
  for (const ImpactMotion& flight : {figures.before, figures.after, figures.flight}) {
    const auto at = static_cast<double>(frame);
    const bool within = flight.known && at >= flight.first_frame && at <= flight.last_frame;
    if (!within || !figures.in_si) continue;
    si.vz_m_s = flight.vz.value;
    si.vz_sd_m_s = flight.vz.sd;
  }
}

}  // namespace

SiRow to_si(const TrackResult& result, std::size_t row) {
  return to_si(result, result.rows[row], row);
}

SiRow to_si(const TrackResult& result, const TrackRow& row, std::size_t i) {
  const TrackRow seen = result.camera          ? result.camera->rows[i]
                        : result.camera_motion ? steadied(row, i, *result.camera_motion)
                                               : row;
  SiRow si = to_si(seen, result.scale);
  add_depth(result.impact_si, seen.frame, si);
  if (!result.camera) return si;
  const CameraRowSd& part = result.camera->row_sd[i];
  si.vx_sd_m_s = std::hypot(si.vx_sd_m_s, part.vx_m_s);
  si.vy_sd_m_s = std::hypot(si.vy_sd_m_s, part.vy_m_s);
  si.omega_sd_rad_s = std::hypot(si.omega_sd_rad_s, part.omega_rad_s);
  return si;
}

RimCentre rim_centre(const TrackRow& row) {
  if (!std::isfinite(row.rim_off_x_px)) {
    return {row.cx_px, row.cy_px, row.cx_sd_px, row.cy_sd_px};
  }
  return {row.cx_px + row.rim_off_x_px, row.cy_px + row.rim_off_y_px, row.rim_x_sd_px,
          row.rim_y_sd_px};
}

std::optional<double> median_radius_px(const TrackRows& rows) {
  std::vector<double> radii;
  radii.reserve(rows.size());
  for (const TrackRow& row : rows) {
    if (row.circle_ok) radii.push_back(row.r_px);
  }
  if (radii.empty()) return std::nullopt;
  return upper_median(std::move(radii));
}

}  // namespace impactdic
