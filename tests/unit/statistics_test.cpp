#include "host/base/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace impactdic {
namespace {

TEST(OrderStatistic, IsThatOfTheSortedValues) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal(0, 10);
  for (const std::size_t count : {1u, 2u, 25u, 518u}) {
    std::vector<float> values(count);
    for (float& value : values) value = std::round(normal(random));  // some of them equal
    std::vector<float> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t rank = 0; rank < count; ++rank) {
      EXPECT_EQ(order_statistic(values, rank), sorted[rank]) << rank << " of " << count;
    }
  }
}

TEST(OrderStatistic, TakesExtremes) {
  constexpr float kMost = std::numeric_limits<float>::infinity();
  constexpr float kTiny = std::numeric_limits<float>::denorm_min();
  const std::vector<float> values = {kMost, -kMost, 0.0f, -kTiny, 3e38f};
  EXPECT_EQ(order_statistic(values, 0), -kMost);
  EXPECT_EQ(order_statistic(values, 1), -kTiny);
  EXPECT_EQ(median(values), 0.0f);
  EXPECT_EQ(order_statistic(values, 3), 3e38f);
  EXPECT_EQ(order_statistic(values, 4), kMost);
}

}  // namespace
}  // namespace impactdic
