#include "sim/shot/track_table.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "host/base/csv_table.h"
#include "host/base/parse.h"

namespace impactdic::sim::shot {
namespace {

constexpr const char* kHeader =
    "frame,time_s,status,cx_px,cy_px,r_px,cx_sd_px,cy_sd_px,r_sd_px,dx_px,dy_px,rot_deg,dx_sd_px,"
    "dy_sd_px,rot_sd_deg,windows,x_m,y_m,vx_m_s,vy_m_s,vt_m_s,vn_m_s,omega_rad_s,vx_sd_m_s,"
    "vy_sd_m_s,omega_sd_rad_s";
constexpr std::size_t kFewestCentres = 20;
constexpr double kUnevenness = 0.01;  // of the interval

void check_times(const CsvTable& table, MeasuredTrack& track) {
  const auto& time = track.time_s;
  if (time.size() < kFewestCentres) {
    throw FormatError(table.file(), -1, "the track has " + std::to_string(time.size()) + " rows",
                      "a calibration needs at least 20");
  }
  track.interval_s = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
  for (std::size_t i = 1; i < time.size(); ++i) {
    if (!(time[i] > time[i - 1])) {
      throw FormatError(table.where(i) + ", column time_s", -1, "time does not ascend");
    }
    if (std::abs(time[i] - time[i - 1] - track.interval_s) > kUnevenness * track.interval_s) {
      throw FormatError(table.where(i) + ", column time_s", -1, "time is not evenly spaced",
                        "keep the row of a frame without a ball, with empty fields");
    }
  }
}

// Metres per pixel, from both coordinates of every centre.
double scale_m_per_px(const std::vector<double>& cx, const std::vector<double>& cy,
                      const MeasuredTrack& track) {
  const auto spread = [](const std::vector<double>& values) {
    double sum = 0, squares = 0, count = 0;
    for (double v : values) {
      if (!std::isnan(v)) sum += v, squares += v * v, ++count;
    }
    return squares / count - sum / count * sum / count;
  };
  return std::sqrt((spread(track.x_m) + spread(track.y_m)) / (spread(cx) + spread(cy)));
}

// sqrt of the mean of two variances; NaN where either is unknown.
std::vector<double> joint_sd(const CsvTable& table, const std::string& a, const std::string& b,
                             double scale) {
  const auto sa = table.numbers(a), sb = table.numbers(b);
  std::vector<double> sd(sa.size());
  for (std::size_t i = 0; i < sd.size(); ++i) {
    if (sa[i] < 0) throw FormatError(table.where(i) + ", column " + a, -1, "is negative");
    if (sb[i] < 0) throw FormatError(table.where(i) + ", column " + b, -1, "is negative");
    sd[i] = scale * std::sqrt((sa[i] * sa[i] + sb[i] * sb[i]) / 2);
  }
  return sd;
}

// The rotation from (vx, vy) to (vt, vn).
double surface_angle_deg(const CsvTable& table) {
  const auto vx = table.numbers("vx_m_s"), vy = table.numbers("vy_m_s");
  const auto vt = table.numbers("vt_m_s"), vn = table.numbers("vn_m_s");
  double cosine = 0, sine = 0;
  for (std::size_t i = 0; i < vx.size(); ++i) {
    const double c = vx[i] * vt[i] + vy[i] * vn[i], s = vy[i] * vt[i] - vx[i] * vn[i];
    if (!std::isnan(c)) cosine += c, sine += s;
  }
  return cosine == 0 && sine == 0 ? kNotMeasured : std::atan2(sine, cosine) * kDegPerRad;
}

std::vector<double> times(std::vector<double> values, double factor) {
  for (double& v : values) v *= factor;
  return values;
}

// A motion that the circles contradict is left out, as `track` does.
void leave_out_contradicted(const CsvTable& table, MeasuredTrack& track) {
  const std::vector<std::string> status = table.text("status");
  for (std::size_t i = 0; i < status.size(); ++i) {
    if (status[i] != "inconsistent") continue;
    track.dx_m[i] = track.dy_m[i] = track.motion_sd_m[i] = kNotMeasured;
    track.turn_rad[i] = track.turn_sd_rad[i] = kNotMeasured;
  }
}

// What a length in px times the scale lacks of its place in metres, the same in every row; nullopt
// where it is not, as of a calibrated camera.
std::optional<double> origin_m(const std::vector<double>& px, double scale,
                               const std::vector<double>& metres) {
  constexpr double kSame_px = 1e-4;
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < px.size(); ++i) {
    const double off = metres[i] - scale * px[i];
    if (!std::isnan(off)) sum += off, ++count;
  }
  const double mean = sum / count;
  for (std::size_t i = 0; i < px.size(); ++i) {
    if (std::abs(metres[i] - scale * px[i] - mean) > kSame_px * std::abs(scale))
      return std::nullopt;
  }
  return mean;
}

// A flat ball's places and angles on keyframes, out of the pose.csv beside the table.
void read_poses(const std::filesystem::path& file, const std::vector<double>& cx,
                const std::vector<double>& cy, MeasuredTrack& track) {
  const double scale = track.metre_per_px;
  const auto x0 = origin_m(cx, scale, track.x_m), y0 = origin_m(cy, -scale, track.y_m);
  if (!x0 || !y0 || !std::filesystem::exists(file)) return;
  const CsvTable table = CsvTable::read(file);
  const auto x = table.numbers("x_px"), y = table.numbers("y_px");
  if (x.size() != track.time_s.size()) return;
  const auto sd = joint_sd(table, "x_sd_px", "y_sd_px", scale);
  const auto angle = table.numbers("angle_deg"), angle_sd = table.numbers("angle_sd_deg");
  const auto origin = table.numbers("origin"), key = table.numbers("keyframe");
  for (std::size_t i = 0; i < x.size(); ++i) {
    TrackPose& pose = track.poses.emplace_back();
    if (std::isnan(angle[i]) || std::isnan(origin[i]) || std::isnan(key[i])) continue;
    pose = {*x0 + scale * x[i],
            *y0 - scale * y[i],
            sd[i],
            angle[i] * kRadPerDeg,
            angle_sd[i] * kRadPerDeg,
            static_cast<std::int64_t>(origin[i]),
            static_cast<std::int64_t>(key[i])};
  }
}

}  // namespace

MeasuredTrack read_track(const std::filesystem::path& file) {
  const CsvTable table = CsvTable::read(file);
  for (const std::string& column : split(kHeader, ',')) {
    if (!table.has(column)) {
      throw FormatError(table.file(), -1, "column '" + column + "' is missing",
                        "this is not a track.csv of impactdic track");
    }
  }
  MeasuredTrack track;
  track.file = table.file();
  track.time_s = table.filled_numbers("time_s");
  check_times(table, track);
  track.x_m = table.numbers("x_m");
  track.y_m = table.numbers("y_m");
  const auto cx = table.numbers("cx_px"), cy = table.numbers("cy_px");
  const auto known = static_cast<std::size_t>(
      std::count_if(track.x_m.begin(), track.x_m.end(), [](double v) { return !std::isnan(v); }));
  if (known == 0) {
    throw FormatError(table.file() + ", column x_m", -1, "the track has no lengths in metres",
                      "track again with --ball-diameter-mm or --mm-per-px");
  }
  if (known < kFewestCentres) {
    throw FormatError(table.file() + ", column x_m", -1,
                      "only " + std::to_string(known) + " frames have a centre",
                      "a calibration needs at least 20");
  }
  const double scale = scale_m_per_px(cx, cy, track);
  if (!(scale > 0) || !std::isfinite(scale)) {
    throw FormatError(table.file(), -1, "the ball does not move");
  }
  track.metre_per_px = scale;
  track.position_sd_m = joint_sd(table, "cx_sd_px", "cy_sd_px", scale);
  track.dx_m = times(table.numbers("dx_px"), scale);
  track.dy_m = times(table.numbers("dy_px"), -scale);  // pixel rows count downwards
  track.motion_sd_m = joint_sd(table, "dx_sd_px", "dy_sd_px", scale);
  track.turn_rad = times(table.numbers("rot_deg"), kRadPerDeg);
  track.turn_sd_rad = times(joint_sd(table, "rot_sd_deg", "rot_sd_deg", 1), kRadPerDeg);
  leave_out_contradicted(table, track);
  track.surface_angle_deg = surface_angle_deg(table);
  read_poses(file.parent_path() / "pose.csv", cx, cy, track);
  return track;
}

}  // namespace impactdic::sim::shot
