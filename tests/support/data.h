// Where the real clips are, for the tests that use them.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace impactdic::testing {

inline std::filesystem::path data_path(const std::string& name) {
  return std::filesystem::path(IMPACTDIC_DATA_DIR) / name;
}

}  // namespace impactdic::testing

// Skips the running test, saying what is missing, where the clip is not on this machine.
#define IMPACTDIC_NEED_DATA(name)                                             \
  if (!std::filesystem::exists(impactdic::testing::data_path(name))) {        \
    GTEST_SKIP() << "needs " << impactdic::testing::data_path(name).string(); \
  }
