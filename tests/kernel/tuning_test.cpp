// The stored choice of a variant, and what is offered on smaller devices.
#include "host/dic/device/tuning.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "tests/support/scratch.h"

namespace impactdic {
namespace {

FieldOptions small_windows() {
  FieldOptions options;
  options.method = FieldMethod::kZncc;
  return options;
}

class Tuning : public ::testing::Test {
 protected:
  testing::ScratchFolder folder_;
  opencl::EngineOptions options() const {
    opencl::EngineOptions out;
    out.cache_dir = folder_.string();
    return out;
  }
  opencl::Engine engine_{"auto", options()};
};

TEST_F(Tuning, TheStoredVariantIsTaken) {
  const auto variants = dic::zncc_variants(engine_.device(), small_windows());
  ASSERT_GT(variants.size(), 2U);
  EXPECT_EQ(dic::choose_zncc_variant(engine_, small_windows()).name(), variants.front().name());
  const std::string work = dic::zncc_work(small_windows());
  dic::store_tuning(engine_, {{"equal 32", "another", 1, 0}, {work, variants[2].name(), 1, 0}});
  EXPECT_EQ(dic::choose_zncc_variant(engine_, small_windows()).name(), variants[2].name());
  // Another size has its own row; what the device does not offer is not taken.
  FieldOptions large = small_windows();
  large.window_px = 31;
  large.search_px = 16;
  EXPECT_EQ(dic::choose_zncc_variant(engine_, large).name(),
            dic::zncc_variants(engine_.device(), large).front().name());
  EXPECT_EQ(dic::choose_equal_variant(engine_, 32).name(),
            dic::equal_variants(engine_.device(), 32).front().name());
  dic::store_tuning(engine_, {{work, variants[1].name(), 1, 0}});
  EXPECT_EQ(dic::choose_zncc_variant(engine_, small_windows()).name(), variants[1].name());
  EXPECT_EQ(dic::tuned_variant(engine_, "equal 32"), "another");
}

TEST_F(Tuning, AnotherDriverOrADamagedFileLeavesTheDefault) {
  const auto variants = dic::zncc_variants(engine_.device(), small_windows());
  const std::string work = dic::zncc_work(small_windows());
  dic::store_tuning(engine_, {{work, variants[1].name(), 1, 0}});
  std::ifstream file(dic::tuning_file(engine_));
  std::string text((std::istreambuf_iterator<char>(file)), {});
  const auto with = [&](const std::string& content) {
    std::ofstream(dic::tuning_file(engine_)) << content;
    return dic::choose_zncc_variant(engine_, small_windows()).name();
  };
  EXPECT_EQ(with(text), variants[1].name());
  std::string other = text;
  const std::string driver = "\"driver\": \"";
  other.insert(other.find(driver) + driver.size(), "x");
  EXPECT_EQ(with(other), variants.front().name());
  EXPECT_EQ(with(text.substr(0, text.size() / 2)), variants.front().name());
  EXPECT_EQ(with("{\"kernels\": [3, {\"device\": 4}]}"), variants.front().name());
  EXPECT_EQ(with(""), variants.front().name());
}

TEST_F(Tuning, MatrixUnitsAreOfferedWhereThereAreSome) {
  opencl::Device device = engine_.device();
  device.is_gpu = true;
  device.vendor = "NVIDIA Corporation";
  device.local_memory_bytes = 48 << 10;
  device.max_work_group = 1024;
  FieldOptions options = small_windows();
  options.window_px = 31;
  options.search_px = 16;
  for (const bool has_some : {false, true}) {
    device.multiplies_bytes = has_some;
    EXPECT_EQ(dic::zncc_variants(device, options).front().matrix_units, has_some);
    const auto equal = dic::equal_variants(device, 32);
    EXPECT_FALSE(equal.front().matrix_units);
    EXPECT_EQ(std::ranges::count_if(equal, &dic::EqualVariant::matrix_units) > 0, has_some);
  }
  options.search_px = 17;  // more lags than the kernel has
  for (const dic::ZnccVariant& variant : dic::zncc_variants(device, options)) {
    EXPECT_FALSE(variant.matrix_units) << variant.name();
  }
}

// 32 KB of local memory, 128 work-items a group.
TEST_F(Tuning, SmallDevicesAreOfferedWhatFits) {
  for (const bool is_gpu : {false, true}) {
    opencl::Device device = engine_.device();
    device.is_gpu = is_gpu;
    device.local_memory_bytes = 32 << 10;
    device.max_work_group = 128;
    for (const int window_px : {7, 15, 31, 63}) {
      FieldOptions options = small_windows();
      options.window_px = window_px;
      const auto variants = dic::zncc_variants(device, options);
      ASSERT_FALSE(variants.empty());
      EXPECT_EQ(variants.back().path, dic::ZnccPath::kClfft);
      EXPECT_EQ(variants.size() > 1, window_px <= 15) << window_px;
      for (const dic::ZnccVariant& variant : variants) {
        if (variant.path == dic::ZnccPath::kClfft) continue;
        EXPECT_LE(variant.local_bytes(options), device.local_memory_bytes) << variant.name();
        EXPECT_LE(variant.lanes, 128) << variant.name();
      }
    }
    for (const dic::EqualVariant& variant : dic::equal_variants(device, 32)) {
      EXPECT_LE(variant.local_bytes(32), device.local_memory_bytes) << variant.name();
    }
    EXPECT_FALSE(dic::equal_variants(device, 32).empty());
  }
}

}  // namespace
}  // namespace impactdic
