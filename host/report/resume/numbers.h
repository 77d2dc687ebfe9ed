// Numbers of resume.json: as they are, to the last bit, and no more than a run may write. Internal
// to the folder.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "host/base/json_number.h"
#include "host/circle/circle.h"

namespace impactdic::report::resume {

using nlohmann::json;

// JSON has no infinity and no NaN.
inline json exact_number(double value) {
  if (std::isfinite(value)) return value;
  return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
}

inline double number_of(const json& value) {
  return value.is_string() ? std::stod(value.get<std::string>()) : value.get<double>();
}

inline constexpr double kMost = 1e7;  // px, rad: far more than any clip shows
inline bool is_usual(double value) { return std::isfinite(value) && std::abs(value) < kMost; }

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

// What follows keeps a damaged or forged file from sending the trackers outside of their pictures.
inline void demand(bool good) {
  if (!good) throw std::runtime_error("no run ends there");
}

inline void check(const Circle& circle) {
  demand(is_usual(circle.cx_px) && is_usual(circle.cy_px) && is_usual(circle.r_px));
  demand(circle.r_px > 0);
}

}  // namespace impactdic::report::resume
