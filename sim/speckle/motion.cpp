#include "sim/speckle/motion.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <cmath>
#include <fstream>
#include <map>
#include <string>

#include "host/base/parse.h"
#include "sim/speckle/blur.h"
#include "sim/speckle/orientation.h"

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
  const bool turned = columns.count("rx_deg") || columns.count("ry_deg") || columns.count("rz_deg");
  if (!both("cx_px", "cy_px") && !both("x_px", "y_px") && !both("dx_px", "dy_px") && !turned &&
      !columns.count("angle_deg") && !columns.count("rot_deg")) {
    throw FormatError(file, 0, "the header names no motion",
                      "columns cx_px,cy_px or dx_px,dy_px, and angle_deg or rot_deg");
  }
  if (turned && !(both("rx_deg", "ry_deg") && columns.count("rz_deg"))) {
    throw FormatError(file, 0, "a rotation vector lacks a component", "rx_deg,ry_deg,rz_deg");
  }
  return columns;
}

BallPose extrapolate(const BallPose& from, const BallPose& to) {
  BallPose next = part_way(from, to, 2);  // the turn
  next.cx_px = to.cx_px + (to.cx_px - from.cx_px);
  next.cy_px = to.cy_px + (to.cy_px - from.cy_px);
  if (from.rx_deg == 0 && from.ry_deg == 0 && to.rx_deg == 0 && to.ry_deg == 0) {
    next.angle_deg = to.angle_deg + (to.angle_deg - from.angle_deg);
  }
  next.compression = to.compression;
  next.compression_axis_deg = to.compression_axis_deg;
  return next;
}

// How far a point of the ball moves between two poses, at most (px).
double travel_px(const BallPose& a, const BallPose& b, double radius_px, double px_per_z) {
  return std::hypot(b.cx_px - a.cx_px, b.cy_px - a.cy_px) +
         radius_px *
             (turn_between(a, b).norm() * kRadPerDeg + std::abs(b.compression - a.compression) +
              a.compression * kRadPerDeg *
                  std::abs(b.compression_axis_deg - a.compression_axis_deg)) +
         px_per_z * std::abs(b.z_px - a.z_px);
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
    pose.z_px += k * motion.dz_px;
    const bool in_plane = motion.start.rx_deg == 0 && motion.start.ry_deg == 0 &&
                          motion.spin_x_deg == 0 && motion.spin_y_deg == 0;
    if (!in_plane) {
      BallPose turned;
      turned.rx_deg = k * motion.spin_x_deg;
      turned.ry_deg = k * motion.spin_y_deg;
      turned.angle_deg = k * motion.rotation_deg;
      set_orientation(pose, orientation_of(turned) * orientation_of(motion.start));
    }
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
  table.placed = columns.count("cx_px") != 0 || columns.count("x_px") != 0;
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
    pose.cx_px = row.need("cx_px", row.need("x_px", pose.cx_px));
    pose.cy_px = row.need("cy_px", row.need("y_px", pose.cy_px));
    pose.z_px = row.need("z_px", 0);
    pose.angle_deg = row.need("rz_deg", row.need("angle_deg", pose.angle_deg));
    pose.rx_deg = row.need("rx_deg", 0);
    pose.ry_deg = row.need("ry_deg", 0);
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

double radius_seen(const BallPose& pose, double radius_px, double distance_radii) {
  if (distance_radii == 0 || pose.z_px == 0) return radius_px;
  const double distance = distance_radii * radius_px;
  return radius_px * distance / (distance - pose.z_px);
}

void write_sphere_truth_csv(const std::filesystem::path& file, std::span<const BallPose> poses,
                            double radius_px, double distance_radii, double fps) {
  std::ofstream out(file);
  out << "frame,time_s,cx_px,cy_px,r_px,dx_px,dy_px,rot_deg,z_px,rx_deg,ry_deg,rz_deg,qw,qx,qy,qz,"
         "rot_x_deg,rot_y_deg\n";
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const BallPose& pose = poses[k];
    std::vector<double> row{static_cast<double>(k) / fps, pose.cx_px, pose.cy_px,
                            radius_seen(pose, radius_px, distance_radii)};
    Eigen::Vector3d turn = Eigen::Vector3d::Constant(kNotMeasured);
    if (k + 1 < poses.size()) {
      turn = turn_between(pose, poses[k + 1]);
      row.insert(row.end(), {poses[k + 1].cx_px - pose.cx_px, poses[k + 1].cy_px - pose.cy_px});
    } else {
      row.insert(row.end(), {kNotMeasured, kNotMeasured});
    }
    Eigen::Quaterniond q = orientation_of(pose);
    if (q.w() < 0) q.coeffs() *= -1;
    row.insert(row.end(), {turn.z(), pose.z_px, pose.rx_deg, pose.ry_deg, pose.angle_deg, q.w(),
                           q.x(), q.y(), q.z(), turn.x(), turn.y()});
    out << k;
    for (const double value : row) out << ',' << shortest(value);
    out << '\n';
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

std::vector<std::pair<BallPose, double>> instants_of(const ShutterPath& path, double radius_px,
                                                     double px_per_z) {
  std::vector<std::pair<BallPose, double>> poses;
  const double before = travel_px(path.open, path.middle, radius_px, px_per_z);
  const double after = travel_px(path.middle, path.close, radius_px, px_per_z);
  if (before == 0 && after == 0) return {{path.middle, 1.0}};
  const auto expose = [&](const BallPose& from, const BallPose& to, double travel) {
    if (travel == 0) {
      poses.emplace_back(from, 0.5);
      return;
    }
    const Quadrature time = gauss_legendre(2 + static_cast<int>(std::ceil(1.2 * travel)));
    for (std::size_t i = 0; i < time.node.size(); ++i) {
      poses.emplace_back(part_way(from, to, time.node[i] + 0.5), 0.5 * time.weight[i]);
    }
  };
  expose(path.open, path.middle, before);
  expose(path.middle, path.close, after);
  return poses;
}

}  // namespace impactdic::sim::speckle
