#include "sim/shot/shot_table.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "host/base/csv_table.h"

namespace impactdic::sim::shot {
namespace {

void refuse_unknown(const CsvTable& table, std::initializer_list<const char*> known) {
  for (const std::string& column : table.columns()) {
    if (std::find(known.begin(), known.end(), column) == known.end()) {
      throw FormatError(table.file(), -1, "column '" + column + "' is not known",
                        "see docs/calibration.md");
    }
  }
}

std::vector<double> optional_numbers(const CsvTable& table, const std::string& column) {
  if (table.has(column)) return table.numbers(column);
  return std::vector<double>(table.rows(), kNotMeasured);
}

}  // namespace

std::vector<TableShot> read_shot_table(const std::filesystem::path& file, const ImpactBody& body,
                                       double gravity_m_s2) {
  const CsvTable table = CsvTable::read(file);
  refuse_unknown(table, {"shot", "surface_angle_deg", "vt_before_m_s", "vn_before_m_s",
                         "omega_before_rad_s", "vt_after_m_s", "vn_after_m_s", "omega_after_rad_s",
                         "vt_after_sd_m_s", "vn_after_sd_m_s", "omega_after_sd_rad_s", "contact_s",
                         "rod_angle_deg", "restitution", "source"});
  if (table.rows() == 0) throw FormatError(table.file(), -1, "the table holds no shot");
  const auto names = table.text("shot");
  const auto angle = table.filled_numbers("surface_angle_deg");
  const auto vt = table.filled_numbers("vt_before_m_s"), vn = table.filled_numbers("vn_before_m_s");
  const auto vt_after = table.numbers("vt_after_m_s"), vn_after = table.numbers("vn_after_m_s");
  const auto vt_sd = optional_numbers(table, "vt_after_sd_m_s");
  const auto vn_sd = optional_numbers(table, "vn_after_sd_m_s");
  const auto spin_sd = optional_numbers(table, "omega_after_sd_rad_s");
  const auto spin = optional_numbers(table, "omega_before_rad_s");
  const auto spin_after = optional_numbers(table, "omega_after_rad_s");
  const auto contact = optional_numbers(table, "contact_s");
  const auto rod_angle = optional_numbers(table, "rod_angle_deg");
  const auto restitution = optional_numbers(table, "restitution");
  std::vector<TableShot> shots;
  for (std::size_t i = 0; i < table.rows(); ++i) {
    if (!(vn[i] < 0)) {
      throw FormatError(table.where(i) + ", column vn_before_m_s", -1,
                        "the body does not approach the surface",
                        "the normal points out of it: negative");
    }
    TableShot row;
    row.name = names[i];
    row.rod_angle_deg = rod_angle[i];
    MeasuredShot& shot = row.shot;
    shot.file = table.file() + ": " + names[i];
    shot.surface_angle_deg = angle[i];
    shot.noise_m = kNotMeasured;
    shot.t_max_compression_s = kNotMeasured;
    shot.max_deflection_m = {kNotMeasured, kNotMeasured};
    shot.contact_start_s = {0, kNotMeasured};
    shot.contact_s = shot.contact_end_s = {contact[i], kNotMeasured};
    shot.before.vt_m_s = {vt[i], kNotMeasured};
    shot.before.vn_m_s = {vn[i], kNotMeasured};
    shot.before.omega_rad_s = {spin[i], kNotMeasured};
    shot.after.vt_m_s = {vt_after[i], vt_sd[i]};
    shot.after.vn_m_s = {vn_after[i], vn_sd[i]};
    shot.after.omega_rad_s = {spin_after[i], spin_sd[i]};
    derive(shot, body, gravity_m_s2);
    if (!std::isnan(restitution[i])) shot.restitution = {restitution[i], kNotMeasured};
    row.restitution = restitution[i];
    shots.push_back(row);
  }
  return shots;
}

std::vector<PrintedFigures> read_printed(const std::filesystem::path& file) {
  const CsvTable table = CsvTable::read(file);
  refuse_unknown(table,
                 {"shot", "model", "vt_m_s", "vn_m_s", "omega_rad_s", "restitution", "source"});
  const auto shot = table.text("shot"), model = table.text("model");
  const auto vt = optional_numbers(table, "vt_m_s"), vn = optional_numbers(table, "vn_m_s");
  const auto omega = optional_numbers(table, "omega_rad_s");
  const auto restitution = optional_numbers(table, "restitution");
  std::vector<PrintedFigures> rows;
  for (std::size_t i = 0; i < table.rows(); ++i) {
    rows.push_back({shot[i], model[i], vt[i], vn[i], omega[i], restitution[i]});
  }
  return rows;
}

PrintedFigures printed_for(const std::vector<PrintedFigures>& rows, const std::string& shot,
                           const std::string& model) {
  for (const PrintedFigures& row : rows) {
    if (row.shot == shot && row.model == model) return row;
  }
  return {shot, model, kNotMeasured, kNotMeasured, kNotMeasured, kNotMeasured};
}

}  // namespace impactdic::sim::shot
