#include "host/report/resume/keyframes_json.h"

#include <cmath>
#include <string>

#include "host/report/resume/numbers.h"

namespace impactdic::report::resume {
namespace {

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
  field("off_x_px", key.off_px[0]);
  field("off_y_px", key.off_px[1]);
  field("off_sd_px", key.off_sd_px);
  field("circle_sd_px", key.circle_sd_px);
  field("anchored", key.anchored);
  field("along_rad", key.along_rad);
}

template <typename Field, typename T>
void each_of_numbers(Field field, const std::string& name, T& numbers) {
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    field(name + "_" + std::to_string(k), numbers[k]);
  }
}

template <typename Field, typename T>
void each_of_link(Field field, T& link) {
  field("from", link.from);
  field("to", link.to);
  each_of_numbers(field, "turn_rad", link.turn_rad);
  each_of_numbers(field, "shift_px", link.shift_px);
  each_of_numbers(field, "covariance", link.covariance);
  each_of_numbers(field, "by_from", link.by_from);
  each_of_numbers(field, "by_to", link.by_to);
  each_of_numbers(field, "by_radius", link.by_radius);
  each_of_numbers(field, "by_nearness", link.by_nearness);
}

template <typename Field, typename T>
void each_of_shape(Field field, T& shape) {
  field("e1", shape.e1);
  field("e2", shape.e2);
  field("sd", shape.sd);
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

}  // namespace

json describe(const motion::Keyframes::Memory& memory) {
  json described = {
      {"keyframes", json::array()}, {"last", json::object()}, {"last_index", memory.last_index}};
  if (std::isfinite(memory.reach_rad)) described["reach_rad"] = exact_number(memory.reach_rad);
  for (const motion::Keyframes::Keyframe& key : memory.keyframes) {
    json& item = described["keyframes"].emplace_back(json::object());
    each_of_keyframe(Writer{item}, key);
    if (key.shape.is_compressed()) each_of_shape(Writer{item["shape"]}, key.shape);
  }
  for (const motion::ChainLink& link : memory.links) {
    each_of_link(Writer{described["links"].emplace_back(json::object())}, link);
  }
  each_of_numbers(Writer{described["link"] = json::object()}, "covariance", memory.link_covariance);
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
  if (described.contains("links")) {
    for (const json& item : described.at("links")) {
      each_of_link(Reader{item}, memory.links.emplace_back());
    }
  }
  each_of_numbers(Reader{described.at("link")}, "covariance", memory.link_covariance);
  each_of_linked(Reader{described.at("last")}, memory.last);
  memory.last_index = whole_number(described.at("last_index"));
  if (described.contains("radius")) each_of_radius(Reader{described.at("radius")}, memory.radius);
  if (described.contains("reach_rad")) memory.reach_rad = number_of(described.at("reach_rad"));
  return memory;
}

void check_keyframes(const motion::Keyframes::Memory& memory, std::int64_t row) {
  demand(memory.last_index >= -1 && memory.last_index <= row);
  check(memory.last, row);
  demand(memory.reach_rad > 0);
  const motion::SphereRadius& radius = memory.radius;
  for (const double value : {radius.px, radius.told_sd_px, radius.error_px, radius.sd_px,
                             radius.nearness_error, radius.nearness_share}) {
    demand(is_usual(value));
  }
  demand(std::abs(radius.correlation) <= 1);
  demand(memory.keyframes.size() <= motion::kKeyframes);
  for (const motion::Keyframes::Keyframe& key : memory.keyframes) {
    demand(key.last_used >= 0 && key.last_used <= row && key.pose.ok);
    check(key.pose, row);
    check(key.circle);
    demand(std::hypot(key.shape.e1, key.shape.e2) < 1 && key.shape.sd >= 0);
    demand(is_usual(key.off_px[0]) && is_usual(key.off_px[1]) && is_usual(key.along_rad));
    demand(key.off_sd_px > 0 && key.circle_sd_px > 0);
  }
  demand(memory.links.size() <= 4 * motion::kKeyframes);
}

}  // namespace impactdic::report::resume
