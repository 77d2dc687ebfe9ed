// pose.csv: where the ball is and how far it has turned since the clip began, without drift.
#pragma once

#include <filesystem>
#include <fstream>
#include <vector>

#include "host/clip/track_row.h"

namespace impactdic::report {

extern const char* const kPoseCsvHeader;

class PoseCsv {
 public:
  // Goes on behind the first `keep` rows of an earlier run, or starts the file anew. Throws
  // FileError here and below where the file cannot be written.
  PoseCsv(std::filesystem::path path, std::int64_t keep);
  void add(const TrackRow& row);
  void flush();

 private:
  std::filesystem::path path_;
  std::ofstream file_;
};

// The poses of an earlier run into its rows, those of the table's beginning. Throws FileError,
// FormatError where the file is no such table.
void read_pose_csv(const std::filesystem::path& path, std::vector<TrackRow>& rows);

}  // namespace impactdic::report
