#include "host/report/pose_csv.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include "host/base/csv_table.h"
#include "host/base/parse.h"

namespace impactdic::report {

const char* const kPoseCsvHeader =
    "frame,time_s,x_px,y_px,angle_deg,x_sd_px,y_sd_px,angle_sd_deg,origin,keyframe";

PoseCsv::PoseCsv(std::filesystem::path path, std::int64_t keep)
    : path_(std::move(path)), file_(continue_table(path_, kPoseCsvHeader, keep)) {}

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
