#include "sim/rod/markers.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>

#include "host/base/csv_table.h"

namespace impactdic::sim::rod {
namespace {

constexpr std::size_t kFewestRows = 12;
constexpr double kFarthest_m = 100;
constexpr double kUnevenness = 0.01;  // of the interval

void check_times(const CsvTable& table, MarkerTable& markers) {
  const auto& time = markers.time_s;
  if (time.size() < kFewestRows) {
    throw FormatError(table.file(), -1, "the table has " + std::to_string(time.size()) + " rows",
                      "velocities before and after an impact need at least 12");
  }
  markers.interval_s = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
  for (std::size_t i = 1; i < time.size(); ++i) {
    const double step = time[i] - time[i - 1];
    if (!(step > 0)) throw FormatError(table.where(i), -1, "time_s does not ascend");
    if (std::abs(step - markers.interval_s) > kUnevenness * markers.interval_s) {
      throw FormatError(table.where(i), -1, "time_s is not evenly spaced",
                        "leave the coordinates of a missed frame empty, but keep its row");
    }
  }
}

}  // namespace

MarkerTable read_markers(const std::filesystem::path& file) {
  const CsvTable table = CsvTable::read(file);
  MarkerTable markers;
  markers.file = table.file();
  markers.time_s = table.filled_numbers("time_s");
  for (std::size_t m = 0; m < 3; ++m) {
    auto& marker = markers.markers[m];
    marker.assign(table.rows(), {kNotMeasured, kNotMeasured, kNotMeasured});
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string column = std::string(1, "xyz"[axis]) + std::to_string(m + 1) + "_m";
      const std::vector<double> values = table.numbers(column);
      for (std::size_t row = 0; row < values.size(); ++row) {
        if (std::abs(values[row]) > kFarthest_m) {
          throw FormatError(table.where(row) + ", column " + column, -1,
                            "a marker farther than 100 m",
                            "metres? a marker out of sight is left empty");
        }
        marker[row][axis] = values[row];
      }
    }
    for (std::size_t row = 0; row < marker.size(); ++row) {
      const auto blank = std::count_if(marker[row].begin(), marker[row].end(),
                                       [](double v) { return std::isnan(v); });
      if (blank == 1 || blank == 2) {
        throw FormatError(table.where(row), -1,
                          "marker " + std::to_string(m + 1) + " has some of its coordinates only");
      }
    }
  }
  check_times(table, markers);
  return markers;
}

std::vector<DeformationRow> read_deformations(const std::filesystem::path& file) {
  const CsvTable table = CsvTable::read(file);
  const auto angle = table.filled_numbers("angle_deg");
  const auto speed = table.filled_numbers("speed_m_s");
  const auto depth = table.filled_numbers("depth_m");
  const auto sd = table.has("depth_sd_m") ? table.numbers("depth_sd_m")
                                          : std::vector<double>(table.rows(), kNotMeasured);
  std::vector<DeformationRow> rows;
  for (std::size_t i = 0; i < table.rows(); ++i) {
    if (!(angle[i] > 0 && angle[i] < 180)) {
      throw FormatError(table.where(i) + ", column angle_deg", -1, "must lie in 0..180");
    }
    if (!(speed[i] > 0)) {
      throw FormatError(table.where(i) + ", column speed_m_s", -1, "must be positive");
    }
    if (depth[i] < 0) throw FormatError(table.where(i) + ", column depth_m", -1, "is negative");
    rows.push_back({angle[i], speed[i], depth[i], sd[i]});
  }
  if (rows.empty()) throw FormatError(table.file(), -1, "the table has no rows");
  return rows;
}

}  // namespace impactdic::sim::rod
