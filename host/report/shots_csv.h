// shots.csv: many shots in one table, a row each.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace impactdic::report {

// One shot of a batch: what the request says of it and what came out.
struct ShotEntry {
  std::string file, name;
  bool done = false;
  std::string reason;  // of a failure
  std::string drop_height_mm, notes;
};

extern const char* const kShotsCsvHeader;

// A row; `summary` is the shot's summary.json, null where it failed.
std::string shots_csv_line(const ShotEntry& shot, const nlohmann::json& summary);

// Writes the whole table in one step. Throws FileError.
void write_shots_csv(const std::filesystem::path& path, const std::vector<std::string>& lines);

}  // namespace impactdic::report
