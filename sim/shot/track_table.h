// A measured track (track.csv of `impactdic track`) as the calibration reads it.
#pragma once

#include <impactdic/fit.h>

#include <filesystem>

namespace impactdic::sim::shot {

// Needs every column of the track's header (interface: frame,time_s,status,cx_px,...). Throws
// FileError or FormatError naming file, line and column: a column is missing, a field is no finite
// number (NaN included: an unmeasured value is an empty field), time does not ascend evenly, a
// standard deviation is negative, fewer than 20 centres are known, or the track has no SI results.
MeasuredTrack read_track(const std::filesystem::path& file);

}  // namespace impactdic::sim::shot
