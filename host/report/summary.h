// summary.json of `track` and `correlate`: the run in figures.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "host/clip/track_row.h"
#include "host/video/clip_digest.h"

namespace impactdic::report {

// The input as it describes itself, with its SHA-256 (null where `digest` is empty).
nlohmann::json describe_input(const ClipInfo& info, const video::ClipDigest& digest);

// Frames by status, mean speed, ball, scale, of all `rows` of the run. Figures that were not
// measured are null.
nlohmann::json summarise_track(const TrackRows& rows, const TrackResult& result);

// Writes `summary` to a temporary file and renames it. Throws FileError.
void write_json(const std::filesystem::path& path, const nlohmann::json& summary);

}  // namespace impactdic::report
