// shots.csv: many shots in one table, a row each.
#pragma once

#include <impactdic/batch.h>

#include <filesystem>
#include <string>
#include <vector>

namespace impactdic::report {

extern const char* const kShotsCsvHeader;

// The surface's angle as a person gave it: back from radians 30 would read 29.999999999999996.
double as_given_deg(double angle_rad);

// What a run measured of a shot.
void fill_shot(ShotResult& shot, const TrackResult& measured);
// The same out of the summary.json of an earlier run. Throws FormatError where that is damaged.
void read_shot(ShotResult& shot, const std::filesystem::path& summary);

// A row; a failed shot has the reason and no figures.
std::string shots_csv_line(const ShotResult& shot);

// "4 of 5 shots measured; table in …": one line for a person.
std::string in_words(const BatchResult& result);

// Writes the whole table in one step. Throws FileError.
void write_shots_csv(const std::filesystem::path& path, const std::vector<std::string>& lines);

}  // namespace impactdic::report
