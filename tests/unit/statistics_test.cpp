#include "host/base/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "host/base/weighted_mean.h"

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
  EXPECT_EQ(upper_median(std::span<const float>(values)), 0.0f);
  EXPECT_EQ(order_statistic(values, 3), 3e38f);
  EXPECT_EQ(order_statistic(values, 4), kMost);
}

TEST(Median, OfAnEvenCountIsTheMeanOrTheUpperOfBothMiddleValues) {
  EXPECT_EQ(median({4, 1, 3, 2}), 2.5);
  EXPECT_EQ(upper_median(std::vector<double>{4, 1, 3, 2}), 3);
  EXPECT_EQ(median({5, 1, 3}), 3);
  EXPECT_EQ(upper_median(std::vector<double>{5, 1, 3}), 3);
  EXPECT_EQ(median({7}), 7);
  EXPECT_EQ(upper_median(std::vector<std::int64_t>{9, 2}), 9);
  EXPECT_EQ(ranked(std::vector<double>{4, 1, 3, 2}, 1), 2);
  EXPECT_EQ(ranked(std::vector<int>{4, 1, 3, 2}, 3), 4);
  EXPECT_TRUE(std::isnan(median({})));
  EXPECT_TRUE(std::isnan(upper_median(std::vector<double>{})));
}

TEST(Median, OfSixIsThatOfTheList) {
  std::mt19937 random(2);
  std::normal_distribution<float> normal(0, 10);
  for (std::size_t count = 1; count <= 6; ++count) {
    std::vector<float> values(count);
    UpperMedianOfSix<float> few(std::numeric_limits<float>::infinity());
    for (float& value : values) few.add(value = std::round(normal(random)));
    EXPECT_EQ(few.median(), upper_median(values)) << count;
  }
}

TEST(Quantile, IsTheValueThatTheShareLiesBelow) {
  const std::vector<float> values = {5, 1, 4, 2, 3};
  EXPECT_EQ(quantile(values, 0), 1);
  EXPECT_EQ(quantile(values, 0.5), 3);
  EXPECT_EQ(quantile(values, 0.8), 5);
  EXPECT_EQ(quantile(values, 1), 5);
  EXPECT_EQ(finite({1, std::nan(""), 2}), (std::vector<double>{1, 2}));
}

TEST(WeightedMean, OfValuesThatAgreeIsAsExactAsTheirWeights) {
  WeightedMean mean;
  mean.add(115.01, 0.03);
  mean.add(114.99, 0.04);
  const double weight = 1 / (0.03 * 0.03) + 1 / (0.04 * 0.04);
  EXPECT_NEAR(mean.value(), 115 + 0.01 * (0.04 * 0.04 - 0.03 * 0.03) / (0.03 * 0.03 + 0.04 * 0.04),
              1e-12);
  EXPECT_DOUBLE_EQ(mean.sd(), 1 / std::sqrt(weight));
}

// A circle that is a pixel off beside one that is right: neither is believed to 0.03 px.
TEST(WeightedMean, OfValuesThatDifferBeyondChanceSaysSo) {
  WeightedMean mean;
  mean.add(114.998, 0.036);
  mean.add(116.6, 0.03);
  EXPECT_GT(mean.sd(), 0.5);
  EXPECT_LT(std::abs(mean.value() - 115), 3 * mean.sd());
  // For two values of one deviation it is half of what they differ by.
  WeightedMean two;
  two.add(1, 0.01);
  two.add(3, 0.01);
  EXPECT_DOUBLE_EQ(two.value(), 2);
  EXPECT_DOUBLE_EQ(two.sd(), 1);
}

}  // namespace
}  // namespace impactdic
