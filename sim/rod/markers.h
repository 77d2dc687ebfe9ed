// The tables of chapter 5: three markers on a rod followed in space, and permanent deformations.
#pragma once

#include <impactdic/rod.h>

#include <filesystem>
#include <vector>

namespace impactdic::sim::rod {

// Header `time_s,x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,x3_m,y3_m,z3_m`, further columns are ignored; the
// coordinates of a marker out of sight are left empty. Throws FileError or FormatError naming file,
// line and column: missing columns, no numbers, uneven or repeated times, fewer than 12 rows,
// coordinates beyond 100 m (some cameras write such a number for a marker out of sight).
MarkerTable read_markers(const std::filesystem::path& file);

// Header `angle_deg,speed_m_s,depth_m` and optionally `depth_sd_m`. Throws as read_markers.
std::vector<DeformationRow> read_deformations(const std::filesystem::path& file);

}  // namespace impactdic::sim::rod
