#include "host/report/pose_csv.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <array>
#include <cmath>

#include "host/base/csv_table.h"
#include "host/base/parse.h"

namespace impactdic::report {

const char* const kPoseCsvHeader =
    "frame,time_s,x_px,y_px,angle_deg,x_sd_px,y_sd_px,angle_sd_deg,origin,keyframe,qw,qx,qy,qz,"
    "tilt_x_sd_deg,tilt_y_sd_deg";

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
    file_ << "," << pose.origin << "," << pose.keyframe;
  } else {
    file_ << ",,";
  }
  const bool flat = std::isfinite(pose.angle_rad);
  const std::array<double, 4> quaternion =
      flat ? std::array{std::cos(pose.angle_rad / 2), 0.0, 0.0, std::sin(pose.angle_rad / 2)}
           : std::array{pose.qw, pose.qx, pose.qy, pose.qz};
  for (const double value : quaternion) file_ << "," << shortest(value);
  file_ << "," << shortest(pose.tilt_x_sd_rad * kDegPerRad) << ","
        << shortest(pose.tilt_y_sd_rad * kDegPerRad) << "\n";
}

void PoseCsv::flush() {
  file_.flush();
  if (!file_) throw FileError("cannot write the file", path_.string(), "is the disk full?");
}

}  // namespace impactdic::report
