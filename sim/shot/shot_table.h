// Shots of which only the velocities before and after are known, as a table: of a paper, or
// measured elsewhere.
#pragma once

#include <impactdic/compare.h>

#include <filesystem>
#include <string>
#include <vector>

#include "sim/shot/shot.h"

namespace impactdic::sim::shot {

// Columns: shot (a name), surface_angle_deg, vt_before_m_s, vn_before_m_s, vt_after_m_s,
// vn_after_m_s; optional omega_before_rad_s, omega_after_rad_s, contact_s, the deviations
// (vt_after_sd_m_s, vn_after_sd_m_s, omega_after_sd_rad_s), rod_angle_deg and restitution (rods),
// and source (text, where the row comes from). An empty field was not measured. Throws FileError or
// FormatError naming file, line and column; an unknown column is an error.
struct TableShot {
  MeasuredShot shot;  // file holds "FILE: NAME"
  std::string name;
  double rod_angle_deg = 0;  // NaN without the column
  double restitution = 0;    // as the table states it; NaN without
};
std::vector<TableShot> read_shot_table(const std::filesystem::path& file, const ImpactBody& body,
                                       double gravity_m_s2);

// What a paper prints for a model and shot, to stand beside what is computed. Columns: shot, model,
// and any of vt_m_s, vn_m_s, omega_rad_s, restitution, source.
std::vector<PrintedFigures> read_printed(const std::filesystem::path& file);
// The row of that shot and model; all NaN where there is none.
PrintedFigures printed_for(const std::vector<PrintedFigures>& rows, const std::string& shot,
                           const std::string& model);

}  // namespace impactdic::sim::shot
