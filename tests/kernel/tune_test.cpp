// The search for the quickest right variant.
#include "host/benchmark/tune.h"

#include <gtest/gtest.h>
#include <impactdic/error.h>

#include "tests/support/engine.h"

namespace impactdic {
namespace {

TEST(Tune, TakesTheQuickestOfTheRightVariants) {
  FieldOptions field;
  field.method = FieldMethod::kZncc;
  field.window_px = 9;
  field.search_px = 3;
  benchmark::TuneOptions options;
  options.seconds = 0.01;
  std::vector<benchmark::TunedVariant> tried;
  const auto keep = [&](const benchmark::TunedVariant& variant) { tried.push_back(variant); };
  const dic::TunedKernel best =
      benchmark::tune_zncc(testing::shared_engine(), field, options, keep);
  EXPECT_EQ(best.work, "zncc 9 in 15");
  ASSERT_EQ(tried.size(), dic::zncc_variants(testing::shared_engine().device(), field).size());
  for (const benchmark::TunedVariant& variant : tried) {
    EXPECT_EQ(variant.rejected, "") << variant.kernel.variant;
    EXPECT_LE(variant.kernel.per_second, best.per_second);
    EXPECT_LT(variant.kernel.difference_px, 1e-4) << variant.kernel.variant;
    EXPECT_GT(variant.kernel.difference_px, 0) << variant.kernel.variant;
  }
  // No single-precision kernel equals the reference to the last bit.
  tried.clear();
  options.largest_difference_px = 0;
  EXPECT_THROW(benchmark::tune_zncc(testing::shared_engine(), field, options, keep), Error);
  for (const benchmark::TunedVariant& variant : tried) {
    EXPECT_EQ(variant.rejected, "differs from the reference") << variant.kernel.variant;
  }
}

}  // namespace
}  // namespace impactdic
