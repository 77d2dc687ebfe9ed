// The tables of chapter 5: three markers on a rod followed in space, and permanent deformations.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace impactdic::sim::rod {

// Marker 1 sits near the end that strikes, marker 2 at the centre of mass, marker 3 near the upper
// end. A marker out of sight has NaN coordinates.
struct MarkerTable {
  std::string file;
  std::vector<double> time_s;                                 // ascending, evenly spaced
  std::array<std::vector<std::array<double, 3>>, 3> markers;  // metres, the camera's own axes
  double interval_s = 0;
};

// Header `time_s,x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,x3_m,y3_m,z3_m`, further columns are ignored; the
// coordinates of a marker out of sight are left empty. Throws FileError or FormatError naming file,
// line and column: missing columns, no numbers, uneven or repeated times, fewer than 12 rows,
// coordinates beyond 100 m (some cameras write such a number for a marker out of sight).
MarkerTable read_markers(const std::filesystem::path& file);

// One row of a permanent-deformation table: an impact and the depth it left.
struct DeformationRow {
  double angle_deg = 0;  // of the rod from the flat
  double speed_m_s = 0;  // of the contact point into the flat, positive
  double depth_m = 0;
  double depth_sd_m = 0;  // NaN: not given
};

// Header `angle_deg,speed_m_s,depth_m` and optionally `depth_sd_m`. Throws as read_markers.
std::vector<DeformationRow> read_deformations(const std::filesystem::path& file);

}  // namespace impactdic::sim::rod
