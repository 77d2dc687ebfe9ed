// The values of settings as files and the command line write them.
#pragma once

#include <impactdic/correlate.h>
#include <impactdic/track.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace impactdic::run {

using SettingValue =
    std::variant<bool, std::int64_t, double, std::string, std::vector<std::string>>;
using SettingValues = std::map<std::string, SettingValue>;  // by key

// Numbers in their shortest exact form; a list's items one a line.
std::string to_text(const SettingValue& value);

inline SettingValue value_of(bool value) { return value; }
inline SettingValue value_of(int value) { return std::int64_t{value}; }
inline SettingValue value_of(double value) { return value; }
inline SettingValue value_of(const std::string& value) { return value; }
inline SettingValue value_of(const std::vector<std::string>& value) { return value; }
SettingValue value_of(FieldMethod value);
SettingValue value_of(Estimator value);
SettingValue value_of(Body value);
SettingValue value_of(ReferenceFrame value);
SettingValue value_of(RegionMotion value);
// Those of which "" stands for nothing asked for.
SettingValue value_of(Channel value);
SettingValue value_of(CameraMotionUse value);
SettingValue value_of(const FrameRange& value);
SettingValue value_of(const std::optional<Roi>& value);
SettingValue value_of(const std::optional<RadiusRange>& value);
SettingValue value_of(const std::optional<RawLayout>& value);
SettingValue value_of(const std::vector<PointPx>& value);
SettingValue value_of(const std::vector<BallByHand>& value);

// Takes a value over; `where` names the setting in errors. Throws InvalidArgument.
void assign(const SettingValue& from, bool& to, const std::string& where);
void assign(const SettingValue& from, int& to, const std::string& where);
void assign(const SettingValue& from, double& to, const std::string& where);
void assign(const SettingValue& from, std::string& to, const std::string& where);
void assign(const SettingValue& from, std::vector<std::string>& to, const std::string& where);
void assign(const SettingValue& from, FieldMethod& to, const std::string& where);
void assign(const SettingValue& from, Estimator& to, const std::string& where);
void assign(const SettingValue& from, Body& to, const std::string& where);
void assign(const SettingValue& from, Channel& to, const std::string& where);
void assign(const SettingValue& from, CameraMotionUse& to, const std::string& where);
void assign(const SettingValue& from, ReferenceFrame& to, const std::string& where);
void assign(const SettingValue& from, RegionMotion& to, const std::string& where);
void assign(const SettingValue& from, FrameRange& to, const std::string& where);
void assign(const SettingValue& from, std::optional<Roi>& to, const std::string& where);
void assign(const SettingValue& from, std::optional<RadiusRange>& to, const std::string& where);
void assign(const SettingValue& from, std::optional<RawLayout>& to, const std::string& where);
void assign(const SettingValue& from, std::vector<PointPx>& to, const std::string& where);
void assign(const SettingValue& from, std::vector<BallByHand>& to, const std::string& where);

}  // namespace impactdic::run
