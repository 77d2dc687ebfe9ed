// Medians and quantiles of many short lists, which stay as they are.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace impactdic {

// The value that `rank` others are below or equal to (0: the least). `values` hold at least
// rank + 1, no NaN. By bisection over all floats there are: every step counts the values up to a
// pivot, several in one instruction and without a branch that depends on them, which for some
// hundred values is several times quicker than to put them in order.
inline float order_statistic(std::span<const float> values, std::size_t rank) {
  // Floats in their order as whole numbers, and back.
  const auto to_key = [](float value) {
    const auto bits = std::bit_cast<std::int32_t>(value);
    return bits ^ ((bits >> 31) & 0x7fffffff);
  };
  const auto to_float = [](std::int32_t key) {
    return std::bit_cast<float>(key ^ ((key >> 31) & 0x7fffffff));
  };
  const std::int32_t size = static_cast<std::int32_t>(values.size());
  const std::int32_t wanted = static_cast<std::int32_t>(rank);
  constexpr float kMost = std::numeric_limits<float>::infinity();
  std::int64_t low = to_key(-kMost), high = to_key(kMost);  // the answer lies in low … high
  std::int32_t below = 0, up_to_high = size;                // values below low, and up to high
  while (low < high && up_to_high - below > 1) {
    const std::int64_t middle = (low + high) >> 1;
    const float pivot = to_float(static_cast<std::int32_t>(middle));
    std::int32_t up_to = 0;
    for (const float value : values) up_to += value <= pivot ? 1 : 0;
    if (up_to > wanted) {
      high = middle;
      up_to_high = up_to;
    } else {
      low = middle + 1;
      below = up_to;
    }
  }
  if (low == high) return to_float(static_cast<std::int32_t>(low));
  // The only one between the bounds is the largest up to the higher.
  const float bound = to_float(static_cast<std::int32_t>(high));
  std::int32_t answer = to_key(-kMost);  // as whole numbers, several are compared at once
  for (const float value : values) {
    const std::int32_t key = value <= bound ? to_key(value) : to_key(-kMost);
    answer = key > answer ? key : answer;
  }
  return to_float(answer);
}

inline float median(std::span<const float> values) {
  return order_statistic(values, values.size() / 2);
}

}  // namespace impactdic
