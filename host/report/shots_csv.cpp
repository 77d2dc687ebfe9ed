#include "host/report/shots_csv.h"

#include <impactdic/error.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "host/base/json_number.h"
#include "host/base/parse.h"
#include "host/report/impact_json.h"
#include "host/report/job/table_file.h"

namespace impactdic::report {
namespace {

using nlohmann::json;

bool is_number(const std::string& text) {
  double value = 0;
  const char* const begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const char* const end = text.data() + text.size();
  return std::from_chars(begin, end, value).ptr == end;
}

// Commas, quotes and line ends would break the row. A spreadsheet takes a text that begins like a
// formula for one and runs it: the apostrophe says that it is a text. Numbers stay as they are.
std::string plain(std::string text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  const bool like_formula =
      begin != std::string::npos && std::string_view("=+-@").find(text[begin]) != std::string::npos;
  if (like_formula && !is_number(text)) text.insert(0, 1, '\'');
  std::replace(text.begin(), text.end(), ',', ';');
  std::replace(text.begin(), text.end(), '"', '\'');
  std::replace(text.begin(), text.end(), '\n', ' ');
  std::replace(text.begin(), text.end(), '\r', ' ');
  return text;
}

void add(std::vector<std::string>& cells, const Measured& m) {
  const bool known = std::isfinite(m.value);
  cells.push_back(number_cell(m.value));
  cells.push_back(known ? number_cell(m.sd) : "");
}

// What contradicts what, and the figures concerned: lists, divided by semicolons.
void add_contradictions(std::vector<std::string>& cells, const ImpactFigures& impact) {
  std::string what, doubtful;
  const auto append = [](std::string& list, const std::string& item) {
    list += (list.empty() ? "" : "; ") + item;
  };
  for (const Contradiction& c : impact.contradictions) append(what, c.message);
  for (std::size_t i = 0; i < kImpactFigures; ++i) {
    const auto figure = static_cast<ImpactFigure>(i);
    if (impact.is_doubtful(figure)) append(doubtful, to_string(figure));
  }
  cells.push_back(plain(what));
  cells.push_back(plain(doubtful));
}

}  // namespace

const char* const kShotsCsvHeader =
    "file,shot,status,reason,surface_angle_deg,drop_height_mm,notes,frames,frames_ok,"
    "scale_m_per_px,impact,t0_s,t0_sd_s,t_max_compression_s,t_max_compression_sd_s,t_end_s,"
    "t_end_sd_s,contact_s,contact_sd_s,vt_before_m_s,vt_before_sd_m_s,vn_before_m_s,"
    "vn_before_sd_m_s,vt_after_m_s,vt_after_sd_m_s,vn_after_m_s,vn_after_sd_m_s,"
    "omega_before_rad_s,omega_before_sd_rad_s,omega_after_rad_s,omega_after_sd_rad_s,"
    "restitution,restitution_sd,friction_eq_3_12,friction_eq_3_12_sd,friction,friction_sd,"
    "rolling_cap,rolling_cap_sd,max_deflection_m,max_deflection_sd_m,impulse_closure,"
    "scale_sd_m_per_px,ball,mass_g,ball_diameter_mm,inertia_factor,surface_angle_found_deg,"
    "surface_angle_found_sd_deg,contradictions,doubtful";

double as_given_deg(double angle_rad) { return std::round(angle_rad * kDegPerRad * 1e9) / 1e9; }

void fill_shot(ShotResult& shot, const TrackResult& measured) {
  shot.surface_angle_deg = as_given_deg(measured.scale.surface_angle_rad);
  shot.frames = measured.frames_measured;
  shot.frames_ok = measured.frames_ok;
  shot.metre_per_px = measured.scale.metre_per_px > 0 ? measured.scale.metre_per_px : kNotMeasured;
  shot.metre_per_px_sd =
      measured.scale.metre_per_px > 0 ? measured.scale.metre_per_px_sd : kNotMeasured;
  // A scale that is the camera's is uncertain with it.
  if (measured.camera && measured.scale.metre_per_px == measured.camera->metre_per_px.value) {
    shot.metre_per_px_sd = measured.camera->metre_per_px.sd;
  }
  shot.impact = measured.impact_si;
}

void read_shot(ShotResult& shot, const std::filesystem::path& summary) {
  try {
    std::ifstream file(summary);
    const json read = json::parse(file);
    const auto number = [&](const char* key) {
      return read.contains(key) && read[key].is_number() ? read[key].get<double>() : kNotMeasured;
    };
    shot.surface_angle_deg = number("surface_angle_deg");
    shot.metre_per_px = number("scale_m_per_px");
    const json::json_pointer scale_sd("/scale/sd_m_per_px");
    if (read.contains(scale_sd) && read.at(scale_sd).is_number()) {
      shot.metre_per_px_sd = read.at(scale_sd).get<double>();
    }
    shot.frames = whole_number(read.at("frames_analysed"));
    shot.frames_ok = 0;
    for (const char* status : {"ok", "last_frame"}) {
      const json& counts = read.at("frames_by_status");
      if (counts.contains(status)) shot.frames_ok += whole_number(counts.at(status));
    }
    shot.impact = read_impact(read.at("impact"));
  } catch (const json::exception&) {
    throw FormatError(summary.string(), -1, "the summary is damaged",
                      "delete the shot's folder, --resume measures it again");
  }
}

std::string shots_csv_line(const ShotResult& shot) {
  const ImpactFigures& impact = shot.impact;
  std::vector<std::string> cells = {plain(shot.file),
                                    plain(shot.name),
                                    shot.done      ? "ok"
                                    : shot.missing ? "missing"
                                                   : "failed",
                                    plain(shot.reason),
                                    shot.done ? number_cell(shot.surface_angle_deg) : "",
                                    plain(shot.drop_height_mm),
                                    plain(shot.notes),
                                    shot.done ? std::to_string(shot.frames) : "",
                                    shot.done ? std::to_string(shot.frames_ok) : "",
                                    shot.done ? number_cell(shot.metre_per_px) : "",
                                    shot.done ? to_string(impact.status) : ""};
  for (const ImpactInstant& instant : {impact.t0, impact.t_max_compression, impact.t_end}) {
    add(cells, {instant.time_s, instant.sd_s});
  }
  // Velocities in px and frames have no place here.
  const auto motion = [&](const ImpactMotion& m) { return impact.in_si ? m : ImpactMotion(); };
  const ImpactMotion before = motion(impact.before), after = motion(impact.after);
  for (const Measured& figure :
       {impact.contact_s, before.vt, before.vn, after.vt, after.vn, before.spin, after.spin,
        impact.restitution, impact.friction_published, impact.friction, impact.rolling_cap,
        impact.max_deflection_m}) {
    add(cells, figure);
  }
  cells.push_back(shot.done && impact.found() ? to_string(impact.closure.verdict) : "");
  cells.push_back(shot.done ? number_cell(shot.metre_per_px_sd) : "");
  cells.push_back(plain(shot.ball));
  cells.push_back(plain(shot.mass_g));
  cells.push_back(shot.done ? number_cell(shot.ball_diameter_mm) : "");
  cells.push_back(shot.done ? number_cell(shot.inertia_factor) : "");
  add(cells, impact.surface_angle_deg);
  add_contradictions(cells, impact);
  std::string line = cells[0];
  for (std::size_t i = 1; i < cells.size(); ++i) line += "," + cells[i];
  return line;
}

std::string in_words(const BatchResult& result) {
  const std::string good = std::to_string(result.shots.size() - result.failed - result.missing);
  if (!result.joined) {
    return good + " shots measured by this process, " + std::to_string(result.failed) + " failed";
  }
  return good + " of " + std::to_string(result.shots.size()) + " shots measured; table in " +
         result.table;
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
