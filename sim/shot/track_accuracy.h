// What `track` says of a track as a whole.
#pragma once

#include <impactdic/fit.h>

#include <filesystem>

namespace impactdic::sim::shot {

// Fills scale_sd and rate_sd from the summary.json beside a track.csv; without one, or where it
// does not say them, both stay as they are. Throws FormatError where it is no JSON.
void read_accuracy(const std::filesystem::path& track_file, MeasuredTrack& track);

}  // namespace impactdic::sim::shot
