#include "host/report/summary.h"

#include <impactdic/error.h>

#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "host/base/json_number.h"
#include "host/report/shots_csv.h"

namespace impactdic::report {
namespace {

using nlohmann::json;

struct Mean {
  double sum = 0;
  int count = 0;
  void add(double value) {
    sum += value;
    ++count;
  }
  double value() const { return count > 0 ? sum / count : kNotMeasured; }
};

}  // namespace

json describe_input(const ClipInfo& info, const video::ClipDigest& digest) {
  const auto or_null = [](const std::string& text) {
    return text.empty() ? json(nullptr) : json(text);
  };
  json input = {{"path", info.path},         {"sha256", or_null(digest.sha256)},
                {"format", info.format},     {"width_px", info.width},
                {"height_px", info.height},  {"bits", info.bits},
                {"frames", info.frame_count}};
  if (!info.header_path.empty()) {
    input["header_path"] = info.header_path;
    input["header_sha256"] = or_null(digest.header_sha256);
  }
  input["camera"] = info.camera.empty() ? json(nullptr) : json(info.camera);
  input["fps"] = info.fps ? json(*info.fps) : json(nullptr);
  input["exposure_s"] = info.exposure_s ? json(*info.exposure_s) : json(nullptr);
  return input;
}

json summarise_track(const TrackRows& rows, const TrackResult& result) {
  const SiScale& scale = result.scale;
  std::map<std::string, int> statuses;
  Mean speed, circle_speed, rotation, windows;
  TrackRow last;  // without a circle
  for (const TrackRow& row : rows) {
    ++statuses[to_string(row.status)];
    if (row.circle_ok && last.circle_ok) {
      circle_speed.add(std::hypot(row.cx_px - last.cx_px, row.cy_px - last.cy_px));
    }
    last = row;
    if (row.motion_ok) {
      speed.add(std::hypot(row.dx_px, row.dy_px));
      rotation.add(row.rot_deg);
      windows.add(row.windows);
    }
  }
  const Measured& radius = result.impact.radius_px;
  const bool metres = scale.metre_per_px > 0;
  const double to_m_s = metres && scale.fps > 0 ? scale.metre_per_px * scale.fps : kNotMeasured;
  return {
      {"frames_analysed", rows.size()},
      {"frames_by_status", statuses},
      {"ball",
       {{"radius_px", json_number(radius.value)},
        {"radius_sd_px", json_number(radius.sd)},
        {"radius_m", json_number(metres ? radius.value * scale.metre_per_px : kNotMeasured)}}},
      {"mean_motion",
       {{"speed_px_per_frame", json_number(speed.value())},
        {"speed_m_s", json_number(speed.value() * to_m_s)},
        {"circle_speed_px_per_frame", json_number(circle_speed.value())},
        {"rotation_deg_per_frame", json_number(rotation.value())},
        {"windows", json_number(windows.value())}}},
      {"scale_m_per_px", json_number(metres ? scale.metre_per_px : kNotMeasured)},
      {"analysed_fps", json_number(scale.fps > 0 ? scale.fps : kNotMeasured)},
      {"surface_angle_deg", as_given_deg(scale.surface_angle_rad)},
  };
}

void write_json(const std::filesystem::path& path, const json& summary) {
  const std::filesystem::path temporary = path.string() + ".part";
  {
    std::ofstream file(temporary);
    // A name of a file that is no UTF-8 is shown as far as it goes.
    file << summary.dump(2, ' ', false, json::error_handler_t::replace) << "\n" << std::flush;
    if (!file) throw FileError("cannot write the file", path.string(), "is the disk full?");
  }
  std::error_code error;
  std::filesystem::rename(temporary, path, error);
  if (error) throw FileError("cannot replace the file: " + error.message(), path.string());
}

}  // namespace impactdic::report
