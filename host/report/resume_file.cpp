#include "host/report/resume_file.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "host/base/json_number.h"
#include "host/base/sha256.h"
#include "host/circle/rim/rim_model.h"
#include "host/report/summary.h"

namespace impactdic::report {
namespace {

using nlohmann::json;

// JSON has no infinity and no NaN.
json exact_number(double value) {
  if (std::isfinite(value)) return value;
  return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
}

double number_of(const json& value) {
  return value.is_string() ? std::stod(value.get<std::string>()) : value.get<double>();
}

constexpr double kMost = 1e7;  // px, rad: far more than any clip shows
bool is_usual(double value) { return std::isfinite(value) && std::abs(value) < kMost; }

// One list of fields serves both ways.
struct Writer {
  json& object;
  template <typename T>
  void operator()(const std::string& name, const T& value) {
    if constexpr (std::is_same_v<T, double>) {
      object[name] = exact_number(value);
    } else if constexpr (std::is_enum_v<T>) {
      object[name] = static_cast<int>(value);
    } else {
      object[name] = value;
    }
  }
};

struct Reader {
  const json& object;
  template <typename T>
  void operator()(const std::string& name, T& value) {
    if constexpr (std::is_same_v<T, double>) {
      value = number_of(object.at(name));
    } else if constexpr (std::is_enum_v<T> || (std::is_integral_v<T> && !std::is_same_v<T, bool>)) {
      value = static_cast<T>(whole_number(object.at(name)));
    } else {
      value = object.at(name).get<T>();
    }
  }
};

template <typename Field, typename T>
void each_of_circle(Field field, T& circle) {
  field("cx_px", circle.cx_px);
  field("cy_px", circle.cy_px);
  field("r_px", circle.r_px);
  field("free_px", circle.free_px);
}

template <typename Field, typename T>
void each_of_fit(Field field, T& fit) {
  each_of_circle(field, fit.circle);
  field("status", fit.status);
  field("cx_sd_px", fit.cx_sd_px);
  field("cy_sd_px", fit.cy_sd_px);
  field("r_sd_px", fit.r_sd_px);
  field("ellipse", fit.ellipse);
  field("e1_px", fit.e1_px);
  field("e2_px", fit.e2_px);
  field("e1_sd_px", fit.e1_sd_px);
  field("e2_sd_px", fit.e2_sd_px);
  field("own_r_px", fit.own_r_px);
  field("own_r_sd_px", fit.own_r_sd_px);
  field("bright", fit.bright);
  field("inked", fit.inked);
  field("residual_px", fit.residual_px);
  field("rim_points", fit.rim_points);
  field("rim_fraction", fit.rim_fraction);
  field("by_hand", fit.by_hand);
}

template <typename Field, typename T>
void each_of_pose(Field field, T& pose) {
  field("ok", pose.ok);
  field("x_px", pose.x_px);
  field("y_px", pose.y_px);
  field("angle_rad", pose.angle_rad);
  field("x_sd_px", pose.x_sd_px);
  field("y_sd_px", pose.y_sd_px);
  field("angle_sd_rad", pose.angle_sd_rad);
  field("qw", pose.qw);
  field("qx", pose.qx);
  field("qy", pose.qy);
  field("qz", pose.qz);
  field("tilt_x_sd_rad", pose.tilt_x_sd_rad);
  field("tilt_y_sd_rad", pose.tilt_y_sd_rad);
  field("key_dx_px", pose.key_dx_px);
  field("key_dy_px", pose.key_dy_px);
  field("key_rot_x_deg", pose.key_rot_x_deg);
  field("key_rot_y_deg", pose.key_rot_y_deg);
  field("key_rot_deg", pose.key_rot_deg);
  field("origin", pose.origin);
  field("keyframe", pose.keyframe);
}

template <typename Field, typename T>
void each_of_linked(Field field, T& pose) {
  each_of_pose(field, pose);
  field("radius_x", pose.radius_x);
  field("radius_y", pose.radius_y);
  field("radius_turn_x_rad", pose.radius_turn_rad[0]);
  field("radius_turn_y_rad", pose.radius_turn_rad[1]);
  field("radius_turn_z_rad", pose.radius_turn_rad[2]);
  field("nearness_x", pose.nearness_x);
  field("nearness_y", pose.nearness_y);
  field("nearness_turn_x_rad", pose.nearness_turn_rad[0]);
  field("nearness_turn_y_rad", pose.nearness_turn_rad[1]);
  field("nearness_turn_z_rad", pose.nearness_turn_rad[2]);
  for (std::size_t k = 0; k < pose.turn_noise_rad2.size(); ++k) {
    field("turn_noise_" + std::to_string(k), pose.turn_noise_rad2[k]);
    field("turn_told_" + std::to_string(k), pose.turn_told_rad2[k]);
  }
}

template <typename Field, typename T>
void each_of_radius(Field field, T& radius) {
  field("px", radius.px);
  field("told_sd_px", radius.told_sd_px);
  field("error_px", radius.error_px);
  field("sd_px", radius.sd_px);
  field("nearness_error", radius.nearness_error);
  field("nearness_share", radius.nearness_share);
  field("correlation", radius.correlation);
}

template <typename Field, typename T>
void each_of_keyframe(Field field, T& key) {
  each_of_linked(field, key.pose);
  each_of_circle(field, key.circle);
  field("residual", key.residual);
  field("last_used", key.last_used);
}

template <typename Field, typename T>
void each_of_shape(Field field, T& shape) {
  field("e1", shape.e1);
  field("e2", shape.e2);
  field("sd", shape.sd);
}

template <typename Field, typename T>
void each_of_correlate(Field field, T& point) {
  field("next_row", point.next_row);
  field("dx_px", point.dx_px);
  field("dy_px", point.dy_px);
  field("rot_rad", point.rot_rad);
  field("vain_searches", point.vain_searches);
}

template <typename T, typename Use>
void each_of_radii(T& tracker, const Use& use) {
  use("radii_px", tracker.radii_px);
  use("own_radii_px", tracker.own_radii_px);
  use("own_radii_sd_px", tracker.own_radii_sd_px);
}

json describe(const circle::BallTracker::Memory& tracker) {
  json described = {{"seen", json::array()},
                    {"radii_px", json::array()},
                    {"own_radii_px", json::array()},
                    {"own_radii_sd_px", json::array()},
                    {"next_learning", tracker.next_learning}};
  for (const circle::BallTracker::Seen& seen : tracker.seen) {
    json& item = described["seen"].emplace_back(json{{"index", seen.index}});
    each_of_fit(Writer{item}, seen.fit);
    // The key of older versions, which this one reads too.
    if (seen.fit.rim_model) item["look"] = seen.fit.rim_model->numbers();
  }
  each_of_radii(tracker, [&](const char* name, const std::deque<double>& radii) {
    for (const double radius : radii) described[name].push_back(exact_number(radius));
  });
  if (tracker.rim_bias) described["rim_bias"] = tracker.rim_bias->numbers();
  return described;
}

circle::BallTracker::Memory tracker_of(const json& described) {
  circle::BallTracker::Memory tracker;
  for (const json& item : described.at("seen")) {
    auto& seen = tracker.seen.emplace_back();
    seen.index = whole_number(item.at("index"));
    each_of_fit(Reader{item}, seen.fit);
    if (item.contains("look")) {
      const auto numbers = item.at("look").get<std::vector<double>>();
      // A width or a step of nothing has no rim.
      if (numbers.size() < 4 || numbers[1] <= 0 || numbers[2] <= 0 ||
          !std::all_of(numbers.begin(), numbers.end(), is_usual)) {
        throw std::runtime_error("this is no rim model");
      }
      seen.fit.rim_model = std::make_shared<circle::RimModel>(numbers);
    }
  }
  tracker.next_learning = whole_number(described.at("next_learning"));
  each_of_radii(tracker, [&](const char* name, std::deque<double>& radii) {
    if (!described.contains(name)) return;  // of an older version
    for (const json& radius : described.at(name)) radii.push_back(number_of(radius));
  });
  if (described.contains("rim_bias")) {
    tracker.rim_bias.emplace(described.at("rim_bias").get<std::array<double, 4>>());
  }
  return tracker;
}

json describe(const motion::Keyframes::Memory& memory) {
  json described = {
      {"keyframes", json::array()}, {"last", json::object()}, {"last_index", memory.last_index}};
  if (std::isfinite(memory.reach_rad)) described["reach_rad"] = exact_number(memory.reach_rad);
  for (const motion::Keyframes::Keyframe& key : memory.keyframes) {
    json& item = described["keyframes"].emplace_back(json::object());
    each_of_keyframe(Writer{item}, key);
    if (key.shape.is_compressed()) each_of_shape(Writer{item["shape"]}, key.shape);
  }
  each_of_linked(Writer{described["last"]}, memory.last);
  each_of_radius(Writer{described["radius"] = json::object()}, memory.radius);
  return described;
}

motion::Keyframes::Memory keyframes_of(const json& described) {
  motion::Keyframes::Memory memory;
  for (const json& item : described.at("keyframes")) {
    motion::Keyframe& key = memory.keyframes.emplace_back();
    each_of_keyframe(Reader{item}, key);
    if (item.contains("shape")) each_of_shape(Reader{item.at("shape")}, key.shape);
  }
  each_of_linked(Reader{described.at("last")}, memory.last);
  memory.last_index = whole_number(described.at("last_index"));
  if (described.contains("radius")) each_of_radius(Reader{described.at("radius")}, memory.radius);
  if (described.contains("reach_rad")) memory.reach_rad = number_of(described.at("reach_rad"));
  return memory;
}

pipeline::ResumePoint point_of(const json& described) {
  pipeline::ResumePoint point;
  point.next_row = whole_number(described.at("next_row"));
  each_of_fit(Reader{described.at("circle")}, point.circle);
  point.tracker = tracker_of(described.at("tracker"));
  if (described.contains("grid_radius_px")) {
    point.grid_radius_px = number_of(described.at("grid_radius_px"));
  }
  if (described.contains("keyframes")) point.keyframes = keyframes_of(described.at("keyframes"));
  return point;
}

// What follows keeps a damaged or forged file from sending the trackers outside of their pictures.
constexpr std::int64_t kMostFrames = std::int64_t{1} << 48;
void demand(bool good) {
  if (!good) throw std::runtime_error("no run ends there");
}

void check(const Circle& circle) {
  demand(is_usual(circle.cx_px) && is_usual(circle.cy_px) && is_usual(circle.r_px));
  demand(circle.r_px > 0);
}

void check(const circle::CircleFit& fit) {
  demand(static_cast<unsigned>(fit.status) <=
         static_cast<unsigned>(circle::CircleStatus::kOutOfView));
  demand(static_cast<unsigned>(fit.by_hand) <= static_cast<unsigned>(ByHand::kAbsent));
  if (fit.status != circle::CircleStatus::kOk) return;
  check(fit.circle);
  for (const double value : {fit.e1_px, fit.e2_px}) demand(is_usual(value));
}

void check(const BodyPose& pose, std::int64_t next_row) {
  if (!pose.ok) return;
  for (const double value : {pose.x_px, pose.y_px}) demand(is_usual(value));
  const double square =
      pose.qw * pose.qw + pose.qx * pose.qx + pose.qy * pose.qy + pose.qz * pose.qz;
  const bool is_sphere = std::isnan(pose.angle_rad) && std::abs(square - 1) < 1e-6;
  demand(is_sphere || is_usual(pose.angle_rad));
  for (const std::int64_t frame : {pose.origin, pose.keyframe}) {
    demand(frame >= 0 && frame <= next_row);
  }
}

void check(const pipeline::ResumePoint& point) {
  const std::int64_t row = point.next_row;
  demand(row >= 0 && row < kMostFrames);
  check(point.circle);
  for (const circle::BallTracker::Seen& seen : point.tracker.seen) {
    demand(seen.index >= 0 && seen.index <= row);
    check(seen.fit);
  }
  for (const double radius : point.tracker.radii_px) demand(is_usual(radius) && radius > 0);
  each_of_radii(point.tracker, [](const char*, const std::deque<double>& radii) {
    for (const double radius : radii) demand(is_usual(radius));
  });
  demand(!point.grid_radius_px || (is_usual(*point.grid_radius_px) && *point.grid_radius_px > 0));
  if (!point.keyframes) return;
  demand(point.keyframes->last_index >= -1 && point.keyframes->last_index <= row);
  check(point.keyframes->last, row);
  demand(point.keyframes->reach_rad > 0);
  const motion::SphereRadius& radius = point.keyframes->radius;
  for (const double value : {radius.px, radius.told_sd_px, radius.error_px, radius.sd_px,
                             radius.nearness_error, radius.nearness_share}) {
    demand(is_usual(value));
  }
  demand(std::abs(radius.correlation) <= 1);
  demand(point.keyframes->keyframes.size() <= motion::kKeyframes);
  for (const motion::Keyframes::Keyframe& key : point.keyframes->keyframes) {
    demand(key.last_used >= 0 && key.last_used <= row && key.pose.ok);
    check(key.pose, row);
    check(key.circle);
    demand(std::hypot(key.shape.e1, key.shape.e2) < 1 && key.shape.sd >= 0);
  }
}

// Throws where the file is damaged or `of` refuses what it says.
template <typename Of>
auto read_point(const std::filesystem::path& path, const char* command, Of of) {
  std::ifstream file(path);
  if (!file) throw FileError("cannot read the file", path.string());
  try {
    json described = json::parse(file);
    // Files of older versions have no digest.
    if (described.contains("sha256")) {
      const std::string digest = described.at("sha256").get<std::string>();
      described.erase("sha256");
      if (sha256_of_text(described.dump()) != digest) throw std::runtime_error("it was changed");
    }
    return of(described);
  } catch (const json::out_of_range&) {  // whole, but without what this version needs
    throw FormatError(path.string(), -1, "another version of impactdic wrote where its run ended",
                      "go on with that version, or start anew with --force without --resume");
  } catch (const std::exception&) {
    throw FormatError(path.string(), -1,
                      std::string("this is not where a run of impactdic ") + command + " ended",
                      "--force without --resume starts anew");
  }
}

void write_point(const std::filesystem::path& path, json described) {
  described["sha256"] = sha256_of_text(described.dump());
  write_json(path, described);
}

}  // namespace

void write_resume_point(const std::filesystem::path& path, const pipeline::ResumePoint& point) {
  json described = {{"next_row", point.next_row}, {"circle", json::object()}};
  each_of_fit(Writer{described["circle"]}, point.circle);
  described["tracker"] = describe(point.tracker);
  if (point.grid_radius_px) described["grid_radius_px"] = exact_number(*point.grid_radius_px);
  if (point.keyframes) described["keyframes"] = describe(*point.keyframes);
  write_point(path, std::move(described));
}

void write_resume_point(const std::filesystem::path& path, const pipeline::CorrelatePoint& point) {
  json described;
  each_of_correlate(Writer{described}, point);
  write_point(path, std::move(described));
}

pipeline::ResumePoint read_resume_point(const std::filesystem::path& path) {
  return read_point(path, "track", [](const json& described) {
    pipeline::ResumePoint point = point_of(described);
    check(point);
    return point;
  });
}

pipeline::CorrelatePoint read_correlate_point(const std::filesystem::path& path) {
  return read_point(path, "correlate", [](const json& described) {
    pipeline::CorrelatePoint point;
    each_of_correlate(Reader{described}, point);
    for (const double value : {point.dx_px, point.dy_px, point.rot_rad}) demand(is_usual(value));
    demand(point.next_row >= 0 && point.next_row < kMostFrames && point.vain_searches >= 0);
    return point;
  });
}

}  // namespace impactdic::report
