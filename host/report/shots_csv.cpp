#include "host/report/shots_csv.h"

#include <impactdic/error.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host/base/parse.h"

namespace impactdic::report {
namespace {

using nlohmann::json;

// Commas, quotes and line ends would break the row.
std::string plain(std::string text) {
  std::replace(text.begin(), text.end(), ',', ';');
  std::replace(text.begin(), text.end(), '"', '\'');
  std::replace(text.begin(), text.end(), '\n', ' ');
  std::replace(text.begin(), text.end(), '\r', ' ');
  return text;
}

// The number at a path of keys; empty where it is missing or null.
std::string number(const json& from, const std::string& pointer) {
  const json::json_pointer path(pointer);
  if (!from.contains(path) || !from.at(path).is_number()) return "";
  return shortest(from.at(path).get<double>());
}

std::string text(const json& from, const std::string& pointer) {
  const json::json_pointer path(pointer);
  return from.contains(path) && from.at(path).is_string() ? from.at(path).get<std::string>() : "";
}

}  // namespace

const char* const kShotsCsvHeader =
    "file,shot,status,reason,surface_angle_deg,drop_height_mm,notes,frames,frames_ok,"
    "scale_m_per_px,impact,t0_s,t0_sd_s,t_max_compression_s,t_max_compression_sd_s,t_end_s,"
    "t_end_sd_s,contact_s,contact_sd_s,vt_before_m_s,vt_before_sd_m_s,vn_before_m_s,"
    "vn_before_sd_m_s,vt_after_m_s,vt_after_sd_m_s,vn_after_m_s,vn_after_sd_m_s,"
    "omega_before_rad_s,omega_before_sd_rad_s,omega_after_rad_s,omega_after_sd_rad_s,"
    "restitution,restitution_sd,friction_eq_3_12,friction_eq_3_12_sd,friction,friction_sd,"
    "rolling_cap,rolling_cap_sd,max_deflection_m,max_deflection_sd_m,impulse_closure";

std::string shots_csv_line(const ShotEntry& shot, const json& summary) {
  double frames_ok = 0;
  for (const char* status : {"ok", "last_frame"}) {
    if (summary.contains("frames_by_status")) {
      frames_ok += summary["frames_by_status"].value(status, 0);
    }
  }
  std::vector<std::string> cells = {plain(shot.file),
                                    plain(shot.name),
                                    shot.done ? "ok" : "failed",
                                    plain(shot.reason),
                                    number(summary, "/surface_angle_deg"),
                                    plain(shot.drop_height_mm),
                                    plain(shot.notes),
                                    number(summary, "/frames_analysed"),
                                    shot.done ? shortest(frames_ok) : "",
                                    number(summary, "/scale_m_per_px"),
                                    text(summary, "/impact/status")};
  for (const char* instant : {"t0", "t_max_compression", "t_end"}) {
    cells.push_back(number(summary, std::string("/impact/") + instant + "/time_s"));
    cells.push_back(number(summary, std::string("/impact/") + instant + "/sd_s"));
  }
  for (const char* figure :
       {"contact_s", "before/vt_m_s", "before/vn_m_s", "after/vt_m_s", "after/vn_m_s",
        "before/omega_rad_s", "after/omega_rad_s", "restitution", "friction/eq_3_12",
        "friction/gravity_corrected", "friction/rolling_cap", "max_deflection_m"}) {
    cells.push_back(number(summary, std::string("/impact/") + figure + "/value"));
    cells.push_back(number(summary, std::string("/impact/") + figure + "/sd"));
  }
  cells.push_back(text(summary, "/impact/impulse_closure/verdict"));
  std::string line = cells[0];
  for (std::size_t i = 1; i < cells.size(); ++i) line += "," + cells[i];
  return line;
}

void write_shots_csv(const std::filesystem::path& path, const std::vector<std::string>& lines) {
  const std::filesystem::path temporary = path.string() + ".part";
  {
    std::ofstream file(temporary);
    file << kShotsCsvHeader << '\n';
    for (const std::string& line : lines) file << line << '\n';
    file.flush();
    if (!file) throw FileError("cannot write the file", path.string(), "is the disk full?");
  }
  std::error_code error;
  std::filesystem::rename(temporary, path, error);
  if (error) throw FileError("cannot replace the file: " + error.message(), path.string());
}

}  // namespace impactdic::report
