// Pictures on their way to the device.
#include "host/opencl/staging.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "tests/support/engine.h"

namespace impactdic {
namespace {

using testing::shared_engine;

// More than the host's memory for it holds, in rows that do not fill it, and less afterwards.
TEST(Staging, BringsEveryRowToItsPlace) {
  const std::unique_ptr<opencl::Engine> engine = shared_engine().beside();
  opencl::Staging staging(*engine);
  for (const auto& [rows, row_bytes] :
       {std::pair<std::size_t, std::size_t>{3000, 1001}, {1, 5}, {3, 700000}, {7000, 999}}) {
    std::vector<unsigned char> expected(rows * row_bytes);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      expected[i] = static_cast<unsigned char>(i * 2654435761U >> 13U);
    }
    const cl::Buffer& device = staging.upload(
        rows, row_bytes, [&](std::size_t first, std::size_t count, unsigned char* to) {
          std::copy_n(expected.data() + first * row_bytes, count * row_bytes, to);
        });
    std::vector<unsigned char> there(expected.size());
    engine->queue().enqueueReadBuffer(device, CL_TRUE, 0, there.size(), there.data());
    EXPECT_EQ(there, expected) << rows;
  }
}

}  // namespace
}  // namespace impactdic
