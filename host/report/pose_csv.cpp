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
    "tilt_x_sd_deg,tilt_y_sd_deg,key_dx_px,key_dy_px,key_rot_x_deg,key_rot_y_deg,key_rot_deg";

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
  for (const double value :
       {pose.tilt_x_sd_rad * kDegPerRad, pose.tilt_y_sd_rad * kDegPerRad, pose.key_dx_px,
        pose.key_dy_px, pose.key_rot_x_deg, pose.key_rot_y_deg, pose.key_rot_deg}) {
    file_ << "," << shortest(value);
  }
  file_ << "\n";
}

void read_pose_csv(const std::filesystem::path& path, std::vector<TrackRow>& rows) {
  std::ifstream file(path);
  if (!file) throw FileError("cannot read the file", path.string());
  std::string line;
  if (!std::getline(file, line) || !is_header_of(trim(line), kPoseCsvHeader)) {
    throw FormatError(path.string(), 0, "this is no such table: its header differs");
  }
  constexpr std::size_t kColumns = 21;
  const std::size_t columns = split(trim(line), ',').size();
  for (TrackRow& row : rows) {
    if (!std::getline(file, line) || file.eof()) return;  // its last line was cut off
    auto cells = split(trim(line), ',');
    if (cells.size() != columns) {
      throw FormatError(path.string(), -1, "a line has " + std::to_string(cells.size()) + " cells");
    }
    cells.resize(kColumns);  // of an older version: not measured
    const auto number = [&](std::size_t i) {
      return cells[i].empty() ? kNotMeasured : parse_double(cells[i], path.string());
    };
    BodyPose& pose = row.pose;
    pose.ok = !cells[8].empty();
    if (!pose.ok) continue;
    pose.x_px = number(2), pose.y_px = number(3);
    pose.angle_rad = number(4) * kRadPerDeg;
    pose.x_sd_px = number(5), pose.y_sd_px = number(6);
    pose.angle_sd_rad = number(7) * kRadPerDeg;
    pose.origin = parse_int(cells[8], path.string());
    pose.keyframe = parse_int(cells[9], path.string());
    if (std::isnan(pose.angle_rad)) {
      pose.qw = number(10), pose.qx = number(11), pose.qy = number(12), pose.qz = number(13);
    }
    pose.tilt_x_sd_rad = number(14) * kRadPerDeg;
    pose.tilt_y_sd_rad = number(15) * kRadPerDeg;
    pose.key_dx_px = number(16), pose.key_dy_px = number(17);
    pose.key_rot_x_deg = number(18), pose.key_rot_y_deg = number(19);
    pose.key_rot_deg = number(20);
  }
}

void PoseCsv::flush() {
  file_.flush();
  if (!file_) throw FileError("cannot write the file", path_.string(), "is the disk full?");
}

}  // namespace impactdic::report
