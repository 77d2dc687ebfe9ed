// The published method: the kernel against the literal double-precision one, and that one against
// what it must do.
#include <gtest/gtest.h>

#include <cmath>

#include "host/dic/correlator.h"
#include "host/dic/frames/cubic_spline.h"
#include "sim/speckle/speckle_field.h"
#include "tests/support/engine.h"

namespace impactdic {
namespace {

using testing::shared_engine;

FieldOptions published_options(int window_px, int points) {
  FieldOptions options;
  options.method = FieldMethod::kPublished;
  options.window_px = window_px;
  options.interp_points = points;
  return options;
}

const sim::speckle::SpeckleField& field() {
  static const sim::speckle::SpeckleField surface(1500, 160, 1.5, 3);
  return surface;
}

std::vector<WindowMotion> run(dic::Correlator& correlator, const std::vector<Frame>& clip,
                              const std::vector<Window>& windows) {
  for (std::size_t i = 0; i < clip.size(); ++i) correlator.set_frame(static_cast<int>(i), clip[i]);
  return correlator.correlate(windows);
}

TEST(CubicSpline, ReproducesCubicsAndSamples) {
  const int samples = 7, points = 3, parts = points + 1;
  const auto matrix = dic::cubic_interpolation_matrix(samples, points);
  const auto cubic = [](double x) { return 2 - x + 0.5 * x * x - 0.25 * x * x * x; };
  ASSERT_EQ(matrix.size(), static_cast<std::size_t>(((samples - 1) * parts + 1) * samples));
  for (int row = 0; row <= (samples - 1) * parts; ++row) {
    double value = 0;
    for (int k = 0; k < samples; ++k) {
      value += matrix[static_cast<std::size_t>(row * samples + k)] * cubic(k);
    }
    EXPECT_NEAR(value, cubic(static_cast<double>(row) / parts), 1e-11);
  }
}

class Published : public ::testing::TestWithParam<int> {};

// Every window, every number of points between pixels: the same lag.
TEST_P(Published, KernelFindsTheLagOfTheLiteralMethod) {
  const int points = GetParam();
  const FieldOptions options = published_options(15, points);
  const std::vector<Frame> clip = {field().render(141, 123, 0, 0, 0, 0, 0, 8, 2, 1),
                                   field().render(141, 123, 1.37, -0.61, 0, 0, 0, 8, 2, 2)};
  std::vector<Window> windows = dic::rectangle_grid(2, 3, 136, 118, 15, points < 6 ? 11 : 23);
  for (Window& window : windows) window.second = 1;
  windows[1].guess_u = 1;
  const auto reference = run(*dic::make_reference_correlator(options, 2), clip, windows);
  const auto device = run(*dic::make_opencl_correlator(shared_engine(), options, 2), clip, windows);
  for (std::size_t i = 0; i < windows.size(); ++i) {
    ASSERT_EQ(device[i].status, static_cast<int>(WindowStatus::kOk)) << i;
    ASSERT_EQ(reference[i].status, static_cast<int>(WindowStatus::kOk)) << i;
    // Lags are multiples of 1/(points + 1) ≥ 0.1 px; what differs by less is the same lag.
    EXPECT_NEAR(device[i].u, reference[i].u, 1e-5) << i;
    EXPECT_NEAR(device[i].v, reference[i].v, 1e-5) << i;
    EXPECT_NEAR(device[i].correlation, reference[i].correlation, 1e-5) << i;
    EXPECT_NEAR(device[i].peak_ratio, reference[i].peak_ratio, 1e-3 * reference[i].peak_ratio) << i;
    EXPECT_NEAR(device[i].u_sd, reference[i].u_sd, 1e-6);
  }
}
INSTANTIATE_TEST_SUITE_P(Points, Published, ::testing::Range(0, 10));

TEST(Published, StatusesAndOtherSizes) {
  for (const int window : {8, 33}) {
    const FieldOptions options = published_options(window, 2);
    std::vector<Frame> clip = {field().render(141, 123, 0, 0, 0, 0, 0, 12),
                               field().render(141, 123, 0.4, 0.4, 0, 0, 0, 12)};
    for (int y = 0; y < 40; ++y) {
      for (int x = 0; x < 40; ++x) clip[1].u16(x, y) = 900;
    }
    const std::vector<Window> windows = {
        {0, 1, 70, 60, 0, 0, 0},   {0, 1, 3, 3, 0, 0, 0},   {0, 1, -1, 60, 0, 0, 0},
        {0, 1, 70, 60, 200, 0, 0}, {1, 0, 70, 60, 0, 0, 0}, {0, 1, 141 - window, 60, 0, 0, 0}};
    const auto reference = run(*dic::make_reference_correlator(options, 2), clip, windows);
    const auto device =
        run(*dic::make_opencl_correlator(shared_engine(), options, 2), clip, windows);
    using enum WindowStatus;
    const WindowStatus expected[] = {kOk, kNoTexture, kOutOfView, kOutOfView, kOk, kOk};
    for (std::size_t i = 0; i < windows.size(); ++i) {
      EXPECT_EQ(device[i].status, static_cast<int>(expected[i])) << window << " " << i;
      EXPECT_EQ(reference[i].status, static_cast<int>(expected[i])) << window << " " << i;
      if (expected[i] != kOk) {
        EXPECT_TRUE(std::isnan(device[i].u) && std::isnan(reference[i].u));
        continue;
      }
      EXPECT_NEAR(device[i].u, reference[i].u, 1e-5) << window << " " << i;
      EXPECT_NEAR(device[i].v, reference[i].v, 1e-5) << window << " " << i;
    }
  }
}

// A whole-pixel motion of a surface that fades out within the window has no overlap to lose.
TEST(Published, FindsTheMotionOfAnIsolatedBlot) {
  sim::speckle::SpeckleField blot(0, 64, 1, 1);
  blot.blots = {{30, 31, 1.2, 0.5}, {32.5, 29.2, 1.1, -0.4}};
  const std::vector<Frame> clip = {blot.render(64, 64, 0, 0, 0, 0, 0, 16),
                                   blot.render(64, 64, 1.5, -0.5, 0, 0, 0, 16)};
  const std::vector<Window> windows = {{0, 1, 24, 22, 0, 0, 0}};
  const auto found =
      run(*dic::make_reference_correlator(published_options(17, 1), 2), clip, windows);
  EXPECT_FLOAT_EQ(found[0].u, 1.5F);
  EXPECT_FLOAT_EQ(found[0].v, -0.5F);
}

}  // namespace
}  // namespace impactdic
