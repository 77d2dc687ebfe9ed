// Medians and quantiles of many short lists, which stay as they are.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

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

// The upper one of the two middle values.
inline float upper_median(std::span<const float> values) {
  return order_statistic(values, values.size() / 2);
}

// As order_statistic, of values of any kind that are given away.
template <typename T>
T ranked(std::vector<T> values, std::size_t rank) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// The upper median of values that are given away; NaN of none.
template <typename T>
T upper_median(std::vector<T> values) {
  if constexpr (std::is_floating_point_v<T>) {
    if (values.empty()) return std::numeric_limits<T>::quiet_NaN();
  }
  const std::size_t middle = values.size() / 2;
  return ranked(std::move(values), middle);
}

// The mean of the two middle values; NaN of none.
inline double median(std::vector<double> values) {
  if (values.size() % 2 == 1 || values.empty()) return upper_median(std::move(values));
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return (*std::max_element(values.begin(), middle) + *middle) / 2;
}

// The value below which the share `q` of `values`, one at least, lies.
inline float quantile(std::span<const float> values, double q) {
  const auto rank = static_cast<std::size_t>(q * static_cast<double>(values.size()));
  return order_statistic(values, std::min(rank, values.size() - 1));
}

// The upper median of up to six values, by exchanges that need no branches: which of them are
// needed is chance.
template <typename T>
class UpperMedianOfSix {
 public:
  // `endless`: infinity.
  explicit UpperMedianOfSix(const T& endless) { values_.fill(endless); }
  void add(const T& value) { values_[count_++] = value; }
  T median() {
    for (const auto& [low, high] : kNetwork) {
      const T a = values_[low], b = values_[high];
      values_[low] = b < a ? b : a;
      values_[high] = a < b ? b : a;
    }
    return values_[count_ / 2];
  }

 private:
  // Sorts six (Knuth, The Art of Computer Programming, volume 3, section 5.3.4).
  static constexpr std::pair<int, int> kNetwork[] = {{0, 5}, {1, 3}, {2, 4}, {1, 2},
                                                     {3, 4}, {0, 3}, {2, 5}, {0, 1},
                                                     {2, 3}, {4, 5}, {1, 2}, {3, 4}};
  std::array<T, 6> values_;
  std::size_t count_ = 0;
};

// Those that were measured.
inline std::vector<double> finite(std::vector<double> values) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  return values;
}

// Standard deviation of a normal distribution over the median of its distances from the middle.
inline constexpr double kSdOfMad = 1.4826;

// Standard deviations on either side of the mean that hold 95 % of a normal distribution.
inline constexpr double kNormal95 = 1.959963984540054;

}  // namespace impactdic
