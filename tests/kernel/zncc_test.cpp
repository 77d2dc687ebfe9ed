// The ZNCC kernels against their double-precision reference.
#include "host/dic/device/zncc.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "host/dic/correlator.h"
#include "sim/speckle/speckle_field.h"
#include "tests/support/engine.h"

namespace impactdic {
namespace {

using testing::shared_engine;

// Single-precision transforms of mean-free pixels: about 1e-6 of the correlation, which is some
// 1e-5 px at the curvature of speckle.
constexpr double kCorrelationTolerance = 1e-5;
constexpr double kShiftTolerancePx = 1e-4;
// Standard deviations stem from 1 − ρ, where the rounding of ρ weighs more.
constexpr double kSdTolerancePx = 2e-4;

const sim::speckle::SpeckleField& field() {
  static const sim::speckle::SpeckleField surface(1500, 160, 1.5, 3);
  return surface;
}

FieldOptions zncc_options() {
  FieldOptions options;
  options.method = FieldMethod::kZncc;
  return options;
}

void expect_same(const WindowMotion& device, const WindowMotion& reference, std::size_t index) {
  ASSERT_EQ(device.status, reference.status)
      << "window " << index << " ZNCC " << device.correlation << " and " << reference.correlation;
  const auto same = [&](float a, float b, double tolerance, const char* what) {
    ASSERT_EQ(std::isnan(a), std::isnan(b)) << what << " of window " << index;
    if (!std::isnan(a)) {
      ASSERT_NEAR(a, b, tolerance) << what << " of window " << index;
    }
  };
  same(device.u, reference.u, kShiftTolerancePx, "u");
  same(device.v, reference.v, kShiftTolerancePx, "v");
  same(device.u_sd, reference.u_sd, kSdTolerancePx, "u_sd");
  same(device.v_sd, reference.v_sd, kSdTolerancePx, "v_sd");
  same(device.correlation, reference.correlation, kCorrelationTolerance, "correlation");
  same(device.peak_ratio, reference.peak_ratio, 1e-3 * std::abs(reference.peak_ratio),
       "peak_ratio");
  same(device.ux, reference.ux, 0, "ux");
}

std::vector<WindowMotion> measure(const FieldOptions& options, const dic::ZnccVariant& variant,
                                  const std::vector<Frame>& clip,
                                  const std::vector<Window>& windows) {
  opencl::Engine& engine = shared_engine();
  dic::DeviceFrames frames(engine, static_cast<int>(clip.size()));
  for (std::size_t i = 0; i < clip.size(); ++i) frames.set(static_cast<int>(i), clip[i]);
  const auto input = opencl::make_buffer<Window>(engine, windows);
  constexpr std::size_t kCanaries = 7;
  WindowMotion canary{};
  canary.u = canary.vy = -77;
  canary.status = -77;
  auto output = opencl::make_buffer<WindowMotion>(
      engine, std::vector<WindowMotion>(windows.size() + kCanaries, canary));
  dic::ZnccOpencl(engine, options, variant).run(frames, input, windows.size(), output);
  auto motions = output.to_vector(engine);
  for (std::size_t i = windows.size(); i < motions.size(); ++i) {
    EXPECT_EQ(motions[i].status, -77);
    EXPECT_EQ(motions[i].u, -77);
    EXPECT_EQ(motions[i].vy, -77);
  }
  motions.resize(windows.size());
  return motions;
}

std::vector<WindowMotion> expected(const FieldOptions& options, const std::vector<Frame>& clip,
                                   const std::vector<Window>& windows) {
  const auto reference = dic::make_reference_correlator(options, static_cast<int>(clip.size()));
  for (std::size_t i = 0; i < clip.size(); ++i) {
    reference->set_frame(static_cast<int>(i), clip[i]);
  }
  return reference->correlate(windows);
}

// Windows everywhere, also across and beyond the picture's edge, at guesses near and off the truth.
std::vector<Window> scattered_windows(int count, int width, int height) {
  std::mt19937 random(11);
  std::uniform_int_distribution<int> x(-4, width), y(-4, height), off(-3, 3);
  std::vector<Window> windows;
  for (int i = 0; i < count; ++i) {
    windows.push_back({0, 1, x(random), y(random), 2 + off(random), -1 + off(random), 0});
  }
  return windows;
}

struct Case {
  int window_px, search_px, count, bits;
  bool every_variant;  // compiling them takes its time: otherwise the default and clFFT
};

std::vector<dic::ZnccVariant> variants_of(const FieldOptions& options, bool every) {
  auto variants = dic::zncc_variants(shared_engine().device(), options);
  if (!every && variants.size() > 2) variants.erase(variants.begin() + 1, variants.end() - 1);
  // Without matrix units: the same kernel but for how it multiplies.
  const int side = options.window_px + 2 * options.search_px;
  if (options.window_px <= 31 && options.search_px <= 16) {
    variants.push_back({dic::ZnccPath::kBytes, side <= 32 ? 32 : 64, 1, 32, true});
  }
  // On a CPU one width of vectors, and the variants as a GPU runs them: each takes seconds to
  // compile.
  if (every && !shared_engine().device().is_gpu) {
    std::erase_if(variants,
                  [](const auto& variant) { return variant.vector == 4 || variant.vector == 16; });
    const int size = side <= 16 ? 16 : 64;
    variants.push_back({dic::ZnccPath::kSingle, size, 1, size, true, false, 0});
    if (size == 16) variants.push_back({dic::ZnccPath::kPairs, size, 1, size, true, false, 0});
  }
  return variants;
}

class Zncc : public ::testing::TestWithParam<Case> {};

TEST_P(Zncc, VariantsAgreeWithTheReference) {
  const Case& c = GetParam();
  FieldOptions options = zncc_options();
  options.window_px = c.window_px;
  options.search_px = c.search_px;
  constexpr int kWidth = 141, kHeight = 123;
  const std::vector<Frame> clip = {
      field().render(kWidth, kHeight, 0, 0, 0, 0, 0, c.bits, 2, 1),
      field().render(kWidth, kHeight, 2.3, -0.6, 0, 0, 0, c.bits, 2, 2)};
  const auto windows = scattered_windows(c.count, kWidth, kHeight);
  const auto reference = expected(options, clip, windows);
  for (const dic::ZnccVariant& variant : variants_of(options, c.every_variant)) {
    SCOPED_TRACE(variant.name());
    const auto device = measure(options, variant, clip, windows);
    for (std::size_t i = 0; i < windows.size(); ++i) expect_same(device[i], reference[i], i);
  }
}
INSTANTIATE_TEST_SUITE_P(Sizes, Zncc,
                         ::testing::Values(Case{15, 8, 1, 8, false}, Case{15, 8, 301, 8, false},
                                           Case{15, 8, 65, 12, false}, Case{7, 4, 203, 16, true},
                                           Case{16, 8, 67, 8, false}, Case{31, 16, 33, 8, true},
                                           Case{33, 20, 9, 16, false}, Case{5, 1, 129, 8, false}));

TEST(Zncc, GivesEachStatusItsReason) {
  FieldOptions options = zncc_options();
  constexpr int kWidth = 141, kHeight = 123;
  std::vector<Frame> clip = {
      field().render(kWidth, kHeight, 0, 0),
      sim::speckle::SpeckleField(1500, 160, 1.5, 99).render(kWidth, kHeight, 0, 0),
      field().render(kWidth, kHeight, 9.4, 0), field().render(kWidth, kHeight, 1.2, 0.4)};
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) clip[0].u8(x, y) = 137;
  }
  options.min_correlation = 0.75;
  std::vector<Window> windows = {
      {0, 3, 60, 60, 0, 0, 0},            // ok
      {0, 3, 10, 10, 0, 0, 0},            // the template is flat
      {0, 1, 60, 60, 0, 0, 0},            // another surface
      {0, 2, 60, 60, 0, 0, 0},            // moved farther than the search reaches
      {0, 3, -1, 60, 0, 0, 0},            // the template leaves the picture
      {0, 3, 60, kHeight - 14, 0, 0, 0},  // likewise at the other end
      {0, 3, 60, 60, 200, 0, 0},          // the search area leaves the picture
      {0, 3, 60, 60, 2147483647, -2147483647 - 1, 0},
      {0, 3, kWidth - 17, 60, 0, 0, 0},  // part of the search area is outside: the rest serves
  };
  const std::vector<WindowStatus> reasons = {
      WindowStatus::kOk,           WindowStatus::kNoTexture, WindowStatus::kLowCorrelation,
      WindowStatus::kAtSearchEdge, WindowStatus::kOutOfView, WindowStatus::kOutOfView,
      WindowStatus::kOutOfView,    WindowStatus::kOutOfView, WindowStatus::kAtSearchEdge};
  // Between two surfaces the highest peak may also lie at the edge; take a window where it does
  // not.
  const auto is_low = [](const WindowMotion& motion) {
    return motion.status == static_cast<int>(WindowStatus::kLowCorrelation);
  };
  auto reference = expected(options, clip, windows);
  while (!is_low(reference[2]) && windows[2].x0 < 100) {
    ++windows[2].x0;
    reference = expected(options, clip, windows);
  }
  for (const dic::ZnccVariant& variant : variants_of(options, false)) {
    SCOPED_TRACE(variant.name());
    const auto device = measure(options, variant, clip, windows);
    for (std::size_t i = 0; i < windows.size(); ++i) expect_same(device[i], reference[i], i);
    for (std::size_t i = 0; i + 1 < windows.size(); ++i) {
      EXPECT_EQ(static_cast<WindowStatus>(device[i].status), reasons[i]) << i;
    }
  }
}

// Black pixels and pixels clipped at white are measured like any other. The spline through the map
// errs by up to 0.06 px on such hard edges; a lost window would err by whole ones.
TEST(Zncc, TrueZerosAreIntensities) {
  FieldOptions options = zncc_options();
  std::vector<Frame> clip = {field().render(141, 123, 0, 0), field().render(141, 123, 3, -2)};
  for (Frame& frame : clip) {
    for (std::size_t i = 0; i < frame.u8.size(); ++i) {
      std::uint8_t& pixel = frame.u8.data()[i];
      pixel = static_cast<std::uint8_t>(std::clamp((pixel - 100) * 3, 0, 255));
    }
  }
  const auto windows = dic::rectangle_grid(20, 20, 100, 80, 15, 9);
  const auto device =
      measure(options, dic::zncc_variants(shared_engine().device(), options).front(), clip, [&] {
        auto both = windows;
        for (Window& window : both) window.second = 1;
        return both;
      }());
  for (const WindowMotion& motion : device) {
    ASSERT_EQ(motion.status, static_cast<int>(WindowStatus::kOk));
    EXPECT_NEAR(motion.u, 3, 0.1);
    EXPECT_NEAR(motion.v, -2, 0.1);
  }
}

// A turn that leaves nothing to correlate is found once it is guessed.
TEST(Zncc, GuessedRotationIsTakenOutOfTheTemplate) {
  FieldOptions options = zncc_options();
  constexpr double kTurn = 0.6;
  const std::vector<Frame> clip = {field().render(141, 123, 0, 0),
                                   field().render(141, 123, 1.3, -0.8, kTurn, 67, 57)};
  std::vector<Window> windows = {{0, 1, 60, 50, 0, 0, static_cast<float>(kTurn)},
                                 {0, 1, 62, 55, 0, 0, static_cast<float>(kTurn)}};
  const auto reference = expected(options, clip, windows);
  for (const dic::ZnccVariant& variant : variants_of(options, false)) {
    SCOPED_TRACE(variant.name());
    const auto device = measure(options, variant, clip, windows);
    for (std::size_t i = 0; i < windows.size(); ++i) expect_same(device[i], reference[i], i);
    ASSERT_EQ(device[0].status, static_cast<int>(WindowStatus::kOk));
    // The interpolated template errs by some hundredths of a pixel.
    EXPECT_NEAR(device[0].u, 1.3, 0.05);
    EXPECT_NEAR(device[0].v, -0.8, 0.05);
  }
  windows[0].guess_rot_rad = 0;
  EXPECT_NE(expected(options, clip, windows)[0].status, static_cast<int>(WindowStatus::kOk));
}

TEST(Correlator, RefusesWindowsWithoutFramesAndOddFrames) {
  for (const bool on_device : {false, true}) {
    const auto correlator = on_device ? dic::make_opencl_correlator(shared_engine(), {}, 2)
                                      : dic::make_reference_correlator({}, 2);
    const std::vector<Window> windows = {{0, 1, 20, 20, 0, 0, 0}};
    EXPECT_THROW(correlator->correlate(windows), InvalidArgument);
    correlator->set_frame(0, field().render(64, 64, 0, 0));
    EXPECT_THROW(correlator->correlate(windows), InvalidArgument);
    EXPECT_THROW(correlator->set_frame(2, field().render(64, 64, 0, 0)), InvalidArgument);
    EXPECT_THROW(correlator->set_frame(1, field().render(65, 64, 0, 0)), InvalidArgument);
    correlator->set_frame(1, field().render(64, 64, 0.5, 0));
    EXPECT_EQ(correlator->correlate(windows)[0].status, static_cast<int>(WindowStatus::kOk));
    EXPECT_TRUE(correlator->correlate({}).empty());
  }
}

}  // namespace
}  // namespace impactdic
