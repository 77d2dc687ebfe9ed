// A measured track (track.csv of `impactdic track`) as the calibration reads it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace impactdic::sim::shot {

// World axes: metres, x right, y up, rotation counter-clockwise. NaN: not measured. Uncertainties
// are one standard deviation. Motion k leads from frame k to frame k + 1.
struct Track {
  std::string file;
  std::vector<double> time_s;
  std::vector<double> x_m, y_m, position_sd_m;  // of the centre
  std::vector<double> dx_m, dy_m, motion_sd_m;  // rigid motion of the surface pattern
  std::vector<double> turn_rad, turn_sd_rad;    // rotation of that motion
  double interval_s = 0;
  double metre_per_px = 0;  // of the table's pixels
  // Of the axes of vt_m_s, vn_m_s in the table; NaN where it has none.
  double surface_angle_deg = 0;
};

// Needs every column of the track's header (interface: frame,time_s,status,cx_px,...). Throws
// FileError or FormatError naming file, line and column: a column is missing, a field is no finite
// number (NaN included: an unmeasured value is an empty field), time does not ascend evenly, a
// standard deviation is negative, fewer than 20 centres are known, or the track has no SI results.
Track read_track(const std::filesystem::path& file);

}  // namespace impactdic::sim::shot
