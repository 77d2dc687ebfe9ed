#include "host/run/batch/shot_line.h"

#include <impactdic/error.h>

#include <nlohmann/json.hpp>

#include "host/base/json_number.h"

namespace impactdic::run {
namespace {

using nlohmann::json;

// A name in a file system is bytes, which need not be UTF-8: each byte as the character of its
// number.
json bytes(const std::string& text) {
  json codes = json::array();
  bool plain = true;
  for (const unsigned char c : text) {
    plain = plain && c < 0x80;
    codes.push_back(static_cast<unsigned>(c));
  }
  return plain ? json(text) : codes;
}

std::string text_of(const json& value) {
  if (value.is_string()) return value.get<std::string>();
  std::string text;
  for (const json& code : value) text += static_cast<char>(whole_number(code));
  return text;
}

}  // namespace

std::string to_line(const BatchShot& shot) {
  json line = {{"clip", bytes(shot.clip.string())},
               {"name", bytes(shot.name)},
               {"drop_height_mm", bytes(shot.drop_height_mm)},
               {"notes", bytes(shot.notes)},
               {"camera", bytes(shot.camera)},
               {"ball", bytes(shot.ball)},
               {"mass_g", bytes(shot.mass_g)},
               {"listed", shot.listed}};
  const auto add = [&](const char* key, const std::optional<double>& value) {
    if (value) line[key] = *value;
  };
  add("surface_angle_deg", shot.surface_angle_deg);
  add("ball_diameter_mm", shot.ball_diameter_mm);
  add("inertia_factor", shot.inertia_factor);
  add("height_mm", shot.height_mm);
  return line.dump();
}

BatchShot parse_shot_line(const std::string& line, const std::string& where) {
  try {
    const json read = json::parse(line);
    BatchShot shot;
    shot.clip = text_of(read.at("clip"));
    shot.name = text_of(read.at("name"));
    shot.drop_height_mm = text_of(read.at("drop_height_mm"));
    shot.notes = text_of(read.at("notes"));
    shot.camera = text_of(read.at("camera"));
    shot.ball = text_of(read.at("ball"));
    shot.mass_g = text_of(read.at("mass_g"));
    shot.listed = read.at("listed").get<bool>();
    const auto number = [&](const char* key) {
      return read.contains(key) ? std::optional<double>(read.at(key).get<double>()) : std::nullopt;
    };
    shot.surface_angle_deg = number("surface_angle_deg");
    shot.ball_diameter_mm = number("ball_diameter_mm");
    shot.inertia_factor = number("inertia_factor");
    shot.height_mm = number("height_mm");
    return shot;
  } catch (const json::exception&) {
    throw FormatError(where, -1, "the ticket of a shot is damaged");
  }
}

}  // namespace impactdic::run
