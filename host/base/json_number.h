// Whole numbers of JSON that others may have written.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>

namespace impactdic {

// A whole number, throws nlohmann::json::type_error on anything else. get<int>() casts whatever
// number stands there, which is undefined for 1e300.
inline std::int64_t whole_number(const nlohmann::json& value) {
  return value.get_ref<const nlohmann::json::number_integer_t&>();
}

}  // namespace impactdic
