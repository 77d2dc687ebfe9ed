#include "host/report/pose_csv.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <string>
#include <vector>

#include "host/base/parse.h"

namespace impactdic::report {

const char* const kPoseCsvHeader =
    "frame,time_s,x_px,y_px,angle_deg,x_sd_px,y_sd_px,angle_sd_deg,origin,keyframe";

namespace {

// The first `count` rows of the file, as they stand; fewer where it has fewer.
std::vector<std::string> first_rows(const std::filesystem::path& path, std::int64_t count) {
  std::vector<std::string> rows;
  std::ifstream file(path);
  std::string line;
  if (count == 0 || !std::getline(file, line) || trim(line) != kPoseCsvHeader) return rows;
  while (static_cast<std::int64_t>(rows.size()) < count && std::getline(file, line)) {
    rows.push_back(line);
  }
  return rows;
}

}  // namespace

PoseCsv::PoseCsv(std::filesystem::path path, std::int64_t keep) : path_(std::move(path)) {
  const std::vector<std::string> kept = first_rows(path_, keep);
  file_.open(path_, std::ios::trunc);
  if (!file_) throw FileError("cannot write the file", path_.string());
  file_ << kPoseCsvHeader << "\n";
  for (const std::string& row : kept) file_ << row << "\n";
}

void PoseCsv::add(const TrackRow& row) {
  file_ << row.frame << "," << shortest(row.time_s);
  const BodyPose& pose = row.pose;
  for (const double value : {pose.x_px, pose.y_px, pose.angle_rad * kDegPerRad, pose.x_sd_px,
                             pose.y_sd_px, pose.angle_sd_rad * kDegPerRad}) {
    file_ << "," << shortest(value);
  }
  if (pose.ok) {
    file_ << "," << pose.origin << "," << pose.keyframe << "\n";
  } else {
    file_ << ",,\n";
  }
}

void PoseCsv::flush() {
  file_.flush();
  if (!file_) throw FileError("cannot write the file", path_.string(), "is the disk full?");
}

}  // namespace impactdic::report
