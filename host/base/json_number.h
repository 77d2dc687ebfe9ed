// Numbers to JSON, and whole numbers out of JSON that others may have written.
#pragma once

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

namespace impactdic {

// JSON has no infinity and no NaN: null for both.
inline nlohmann::json json_number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

// A whole number, throws nlohmann::json::type_error on anything else. get<int>() casts whatever
// number stands there, which is undefined for 1e300.
inline std::int64_t whole_number(const nlohmann::json& value) {
  return value.get_ref<const nlohmann::json::number_integer_t&>();
}

}  // namespace impactdic
