#include "host/run/settings/setting_value.h"

#include <impactdic/error.h>

#include <limits>

#include "host/base/parse.h"
#include "host/clip/ball_by_hand.h"
#include "host/clip/frame_range.h"
#include "host/clip/roi.h"
#include "host/video/frame_source.h"

namespace impactdic::run {
namespace {

struct TextOf {
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(std::int64_t value) const { return std::to_string(value); }
  std::string operator()(double value) const { return shortest(value); }
  std::string operator()(const std::string& value) const { return value; }
  std::string operator()(const std::vector<std::string>& values) const {
    std::string text;
    for (const std::string& value : values) text += (text.empty() ? "" : "\n") + value;
    return text;
  }
};

// "" leaves it without a value.
template <typename T, typename Read>
void assign_optional(const SettingValue& from, std::optional<T>& to, Read read) {
  const std::string text = to_text(from);
  to.reset();
  if (!text.empty()) to = read(text);
}

RadiusRange read_radius(const std::string& text) {
  const auto range = parse_doubles(text, ':', 2, "--radius-px");
  return {range[0], range[1]};
}

}  // namespace

std::string to_text(const SettingValue& value) { return std::visit(TextOf(), value); }

SettingValue value_of(FieldMethod value) { return std::string(to_string(value)); }
SettingValue value_of(Body value) { return std::string(to_string(value)); }
SettingValue value_of(Channel value) {
  return std::string(value == Channel::kLuminance ? "" : to_string(value));
}
SettingValue value_of(CameraMotionUse value) { return std::string(to_string(value)); }
SettingValue value_of(Estimator value) { return std::string(to_string(value)); }
SettingValue value_of(ReferenceFrame value) { return std::string(to_string(value)); }
SettingValue value_of(RegionMotion value) { return std::string(to_string(value)); }
SettingValue value_of(const FrameRange& value) { return impactdic::to_text(value); }
SettingValue value_of(const std::vector<PointPx>& value) { return impactdic::to_text(value); }
SettingValue value_of(const std::vector<BallByHand>& value) { return impactdic::to_text(value); }
SettingValue value_of(const std::optional<Roi>& value) {
  return value ? impactdic::to_text(*value) : std::string();
}
SettingValue value_of(const std::optional<RadiusRange>& value) {
  return value ? shortest(value->low_px) + ":" + shortest(value->high_px) : std::string();
}
SettingValue value_of(const std::optional<RawLayout>& value) {
  return value ? video::to_text(*value) : std::string();
}

void assign(const SettingValue& from, bool& to, const std::string& where) {
  const std::string text = to_text(from);
  if (text != "true" && text != "false") {
    throw InvalidArgument("the value must be true or false, not " + text, where);
  }
  to = text == "true";
}

void assign(const SettingValue& from, int& to, const std::string& where) {
  const std::string text = to_text(from);
  const std::int64_t number = parse_int(text, where);
  if (number < std::numeric_limits<int>::min() || number > std::numeric_limits<int>::max()) {
    throw InvalidArgument(text + " is too large", where);
  }
  to = static_cast<int>(number);
}

void assign(const SettingValue& from, double& to, const std::string& where) {
  to = parse_double(to_text(from), where);
}

void assign(const SettingValue& from, std::string& to, const std::string&) { to = to_text(from); }

void assign(const SettingValue& from, std::vector<std::string>& to, const std::string&) {
  const auto* list = std::get_if<std::vector<std::string>>(&from);
  to = list != nullptr ? *list : std::vector<std::string>{to_text(from)};
}

void assign(const SettingValue& from, FieldMethod& to, const std::string&) {
  to = parse_field_method(to_text(from));
}
void assign(const SettingValue& from, Estimator& to, const std::string&) {
  to = parse_estimator(to_text(from));
}
void assign(const SettingValue& from, Body& to, const std::string&) {
  to = parse_body(to_text(from));
}
void assign(const SettingValue& from, Channel& to, const std::string&) {
  const std::string name = to_text(from);
  to = name.empty() ? Channel::kLuminance : parse_channel(name);
}
void assign(const SettingValue& from, CameraMotionUse& to, const std::string&) {
  to = parse_camera_motion(to_text(from));
}
void assign(const SettingValue& from, ReferenceFrame& to, const std::string&) {
  to = parse_reference(to_text(from));
}
void assign(const SettingValue& from, RegionMotion& to, const std::string&) {
  to = parse_region_motion(to_text(from));
}
void assign(const SettingValue& from, FrameRange& to, const std::string&) {
  to = read_frame_range(to_text(from));
}
void assign(const SettingValue& from, std::optional<Roi>& to, const std::string&) {
  assign_optional(from, to, read_roi);
}
void assign(const SettingValue& from, std::optional<RadiusRange>& to, const std::string&) {
  assign_optional(from, to, read_radius);
}
void assign(const SettingValue& from, std::optional<RawLayout>& to, const std::string&) {
  assign_optional(from, to, video::parse_raw_layout);
}
void assign(const SettingValue& from, std::vector<PointPx>& to, const std::string&) {
  const std::string text = to_text(from);
  to = text.empty() ? std::vector<PointPx>() : read_polygon(text);
}
void assign(const SettingValue& from, std::vector<BallByHand>& to, const std::string&) {
  const std::string text = to_text(from);
  to = text.empty() ? std::vector<BallByHand>() : read_balls_by_hand(text);
}

}  // namespace impactdic::run
