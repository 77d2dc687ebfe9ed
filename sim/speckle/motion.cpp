#include "sim/speckle/motion.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <cmath>
#include <fstream>
#include <map>
#include <string>

#include "host/base/parse.h"

namespace impactdic::sim::speckle {
namespace {

// One CSV row by column name; empty fields read as NaN.
class Row {
 public:
  Row(const std::map<std::string, std::size_t>& columns, std::vector<std::string> fields,
      std::string where)
      : columns_(columns), fields_(std::move(fields)), where_(std::move(where)) {}

  double get(const std::string& name, double otherwise) const {
    const auto found = columns_.find(name);
    if (found == columns_.end()) return otherwise;
    const std::string field = trim(fields_.at(found->second));
    return field.empty() ? kNotMeasured : parse_double(field, name + " (" + where_ + ")");
  }
  // A value that a pose cannot do without.
  double need(const std::string& name, double otherwise) const {
    const double value = get(name, otherwise);
    if (!std::isfinite(value)) throw FormatError(where_, -1, name + " is empty");
    return value;
  }

 private:
  const std::map<std::string, std::size_t>& columns_;
  std::vector<std::string> fields_;
  std::string where_;
};

std::map<std::string, std::size_t> read_header(const std::string& line, const std::string& file) {
  std::map<std::string, std::size_t> columns;
  for (const std::string& name : split(line, ',')) columns.emplace(trim(name), columns.size());
  const auto both = [&](const char* a, const char* b) {
    return columns.count(a) && columns.count(b);
  };
  if (!both("cx_px", "cy_px") && !both("dx_px", "dy_px") && !columns.count("angle_deg") &&
      !columns.count("rot_deg")) {
    throw FormatError(file, 0, "the header names no motion",
                      "columns cx_px,cy_px or dx_px,dy_px, and angle_deg or rot_deg");
  }
  return columns;
}

BallPose extrapolate(const BallPose& from, const BallPose& to) {
  BallPose next = to;
  next.cx_px += to.cx_px - from.cx_px;
  next.cy_px += to.cy_px - from.cy_px;
  next.angle_deg += to.angle_deg - from.angle_deg;
  return next;
}

BallPose part_way(const BallPose& from, const BallPose& to, double share) {
  const auto mix = [share](double a, double b) { return a + share * (b - a); };
  return {mix(from.cx_px, to.cx_px), mix(from.cy_px, to.cy_px), mix(from.angle_deg, to.angle_deg),
          mix(from.compression, to.compression),
          mix(from.compression_axis_deg, to.compression_axis_deg)};
}

}  // namespace

std::vector<BallPose> constant_motion(const ConstantMotion& motion, int frames) {
  std::vector<BallPose> poses;
  for (int k = 0; k < frames; ++k) {
    BallPose pose = motion.start;
    pose.cx_px += k * motion.dx_px;
    pose.cy_px += k * motion.dy_px;
    pose.angle_deg += k * motion.rotation_deg;
    pose.compression += k * motion.compression_per_frame;
    poses.push_back(pose);
  }
  return poses;
}

GivenMotion read_motion_csv(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw FileError("cannot read the motion", file.string(), "is the path right?");
  std::string line;
  if (!std::getline(in, line)) throw FormatError(file.string(), 0, "the file is empty");
  const auto columns = read_header(line, file.string());
  GivenMotion table;
  table.placed = columns.count("cx_px") != 0;
  BallPose sum;  // where summed columns have led
  for (int number = 2; std::getline(in, line); ++number) {
    if (trim(line).empty()) continue;
    const std::string where = file.string() + ", line " + std::to_string(number);
    std::vector<std::string> fields = split(line, ',');
    if (fields.size() != columns.size()) {
      throw FormatError(where, -1,
                        "has " + std::to_string(fields.size()) + " fields, the header " +
                            std::to_string(columns.size()));
    }
    const Row row(columns, std::move(fields), where);
    BallPose pose = sum;
    pose.cx_px = row.need("cx_px", pose.cx_px);
    pose.cy_px = row.need("cy_px", pose.cy_px);
    pose.angle_deg = row.need("angle_deg", pose.angle_deg);
    pose.compression = row.need("compression", pose.compression);
    pose.compression_axis_deg = row.need("compression_axis_deg", pose.compression_axis_deg);
    table.poses.push_back(pose);
    // The last row's motion may be empty; then nothing follows that would need it.
    sum.cx_px += row.get("dx_px", 0);
    sum.cy_px += row.get("dy_px", 0);
    sum.angle_deg += row.get("rot_deg", 0);
  }
  if (table.poses.empty()) throw FormatError(file.string(), -1, "no row follows the header");
  return table;
}

void write_truth_csv(const std::filesystem::path& file, std::span<const BallPose> poses,
                     double radius_px, double fps) {
  std::ofstream out(file);
  out << "frame,time_s,cx_px,cy_px,r_px,dx_px,dy_px,rot_deg\n";
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const BallPose& pose = poses[k];
    out << k << ',' << shortest(static_cast<double>(k) / fps) << ',' << shortest(pose.cx_px) << ','
        << shortest(pose.cy_px) << ',' << shortest(radius_px) << ',';
    if (k + 1 < poses.size()) {
      const BallPose& next = poses[k + 1];
      out << shortest(next.cx_px - pose.cx_px) << ',' << shortest(next.cy_px - pose.cy_px) << ','
          << shortest(next.angle_deg - pose.angle_deg) << '\n';
    } else {
      out << ",,\n";
    }
  }
  out.close();
  if (!out) throw FileError("cannot write the truth", file.string(), "is the disk full?");
}

void write_compression_csv(const std::filesystem::path& file, std::span<const BallPose> poses) {
  std::ofstream out(file);
  out << "frame,compression,compression_axis_deg\n";
  for (std::size_t k = 0; k < poses.size(); ++k) {
    out << k << ',' << shortest(poses[k].compression) << ','
        << shortest(poses[k].compression_axis_deg) << '\n';
  }
  out.close();
  if (!out) throw FileError("cannot write the truth", file.string(), "is the disk full?");
}

ShutterPath shutter_path(std::span<const BallPose> poses, std::size_t index, double exposure) {
  const BallPose& here = poses[index];
  if (exposure <= 0 || poses.size() < 2) return {here, here, here};
  const bool first = index == 0, last = index + 1 == poses.size();
  const BallPose before = first ? extrapolate(poses[1], here) : poses[index - 1];
  const BallPose after = last ? extrapolate(poses[index - 1], here) : poses[index + 1];
  return {part_way(here, before, exposure / 2), here, part_way(here, after, exposure / 2)};
}

}  // namespace impactdic::sim::speckle
