// The tables that people open: track.csv and motion.csv. Empty cells are values that were not
// measured. Headers are part of the interface and never change order.
#pragma once

#include <impactdic/correlate.h>

#include <filesystem>
#include <fstream>
#include <span>
#include <vector>

#include "host/clip/track_row.h"

namespace impactdic::report {

extern const char* const kTrackCsvHeader;
extern const char* const kMotionCsvHeader;

// One line of track.csv without its end.
std::string track_csv_line(const TrackRow& row, const SiScale& scale);

// track.csv while a clip is running: every row is on disk soon after it was measured. The scale
// may only be known at the end; `finish` then writes the whole table anew with it, in one step.
class TrackCsv {
 public:
  // Goes on behind the first `keep` rows of an earlier run, or starts the file anew. Throws
  // FileError here and below where the file cannot be written.
  TrackCsv(std::filesystem::path path, const SiScale& scale, std::int64_t keep);
  void add(std::span<const TrackRow> rows);
  void flush();
  // `rows`: all of the run's.
  void finish(const TrackRows& rows, const TrackResult& result);

 private:
  std::filesystem::path path_;
  SiScale scale_;
  std::ofstream file_;
};

// camera_motion.csv: where the background lies in each row's picture. `rows`: those of the run.
// Throws FileError.
void write_camera_motion_csv(const std::filesystem::path& path, const TrackRows& rows,
                             const CameraMotion& motion);

// Reads a track.csv back, as far as its pixels go. A last line that was cut off is dropped.
// Throws FileError, FormatError.
std::vector<TrackRow> read_track_csv(const std::filesystem::path& path);

// motion.csv while a clip is running.
class MotionCsv {
 public:
  // As TrackCsv's.
  MotionCsv(std::filesystem::path path, std::int64_t keep);
  void add(const MotionRow& row);
  void flush();

 private:
  std::filesystem::path path_;
  std::ofstream file_;
};

// As read_track_csv, of a motion.csv.
std::vector<MotionRow> read_motion_csv(const std::filesystem::path& path);

}  // namespace impactdic::report
