// prefilter.cl and icgn.cl against their double-precision references.
#include "host/dic/device/icgn.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "host/dic/correlator.h"
#include "host/dic/reference/icgn.h"
#include "kernels/spline.h"
#include "tests/support/engine.h"
#include "tests/support/speckle_frames.h"

namespace impactdic {
namespace {

using testing::pose;
using testing::shared_engine;

Frame random_frame(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  Frame frame;
  frame.reset(width, height, 8);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) frame.u8(x, y) = static_cast<std::uint8_t>(random() % 256);
  }
  return frame;
}

struct SplineCase {
  int degree;
  double sigma_px;
  int width, height;
  std::optional<dic::Tiling> tiling = {};
};
class Prefilter : public ::testing::TestWithParam<SplineCase> {};

TEST_P(Prefilter, CoefficientsAndPlanesAreTheReferences) {
  const auto [degree, sigma, width, height, tiling] = GetParam();
  opencl::Engine& engine = shared_engine();
  constexpr int kSlots = 3;
  dic::DeviceFrames frames(engine, kSlots);
  std::vector<Frame> pictures;
  for (int slot = 0; slot < kSlots; ++slot) {
    pictures.push_back(random_frame(width, height, 7 + static_cast<unsigned>(slot)));
    if (slot != 1) frames.set(slot, pictures.back());
  }
  const dic::SplineFrames& splines = frames.splines(degree, sigma, tiling);
  EXPECT_EQ(&splines, &frames.splines(degree, sigma, tiling));
  const auto coefficients = splines.coefficients().to_vector(engine);
  const auto planes = splines.planes().to_vector(engine);
  for (const int slot : {0, 2}) {
    const dic::BSplineImage reference(dic::to_double(pictures[static_cast<std::size_t>(slot)]),
                                      degree, sigma);
    for (int y = -SPLINE_PAD; y < height + SPLINE_PAD; ++y) {
      for (int x = -SPLINE_PAD; x < width + SPLINE_PAD; ++x) {
        const auto at = static_cast<std::size_t>(
            splines.coefficient_offset() +
            (slot * (height + 2 * SPLINE_PAD) + y + SPLINE_PAD) * splines.pitch() + x + SPLINE_PAD);
        // Coefficients of white noise reach 255 · (gain of the filter, 30 a side for degree 7);
        // single precision keeps 6e-8 of the sum of magnitudes.
        ASSERT_NEAR(coefficients[at], reference.coefficient(x, y), 4e-3) << x << ' ' << y;
      }
    }
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const auto sample = reference.sample(x, y);
        const auto at =
            static_cast<std::size_t>((slot * 3 * height + y) * splines.plane_pitch() + x);
        const auto plane = static_cast<std::size_t>(height * splines.plane_pitch());
        ASSERT_NEAR(planes[at], sample.value, 2e-3);
        ASSERT_NEAR(planes[at + plane], sample.slope_x, 3e-3);
        ASSERT_NEAR(planes[at + 2 * plane], sample.slope_y, 3e-3);
      }
    }
  }
  // Slot 1 holds nothing, and nothing was written before the first or behind the last slot.
  const auto slot_size = static_cast<std::size_t>((height + 2 * SPLINE_PAD) * splines.pitch());
  const auto offset = static_cast<std::size_t>(splines.coefficient_offset());
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    const bool written = i >= offset && i < offset + 3 * slot_size && (i - offset) / slot_size != 1;
    if (!written) {
      ASSERT_EQ(coefficients[i], 0.0f) << i;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Cases, Prefilter,
                         ::testing::Values(SplineCase{3, 0, 64, 48}, SplineCase{5, 0, 131, 37},
                                           SplineCase{7, 0.5, 97, 101}, SplineCase{5, 0.8, 16, 9},
                                           SplineCase{7, 0, 5, 3},
                                           SplineCase{5, 0.5, 70, 41, dic::Tiling{1, 64}},
                                           SplineCase{3, 0, 33, 20, dic::Tiling{4, 1}}));

struct IcgnCase {
  int window_px, degree;
  double rotation_deg, guess_deg;
  std::optional<dic::Tiling> tiling = {};  // other than this device's own
};
class Icgn : public ::testing::TestWithParam<IcgnCase> {
 protected:
  static constexpr int kSize = 160;
  static std::vector<Frame> ball_frames(double rotation_deg, double noise) {
    SynthScene scene;
    scene.width = kSize;
    scene.height = kSize - 3;
    scene.noise_sigma = noise;
    return testing::render_frames(testing::quick_ball(5, 70), scene,
                                  {pose(79.3, 78.4, 0), pose(80.67, 77.79, rotation_deg)});
  }
};

// Seeds a quarter of a pixel off in a random direction.
WindowMotion seed_for(const Window& window, int side, double rotation_deg, std::mt19937& random) {
  const double x = window.x0 + (side - 1) / 2.0 - 79.3, y = window.y0 + (side - 1) / 2.0 - 78.4;
  const double c = std::cos(rotation_deg * M_PI / 180), s = std::sin(rotation_deg * M_PI / 180);
  std::uniform_real_distribution<double> off(-0.25, 0.25);
  WindowMotion seed{};
  seed.u = static_cast<float>(80.67 - 79.3 + c * x + s * y - x + off(random));
  seed.v = static_cast<float>(77.79 - 78.4 - s * x + c * y - y + off(random));
  seed.peak_ratio = 3;
  return seed;
}

// Single precision and the convergence limit against double precision.
void expect_near(const WindowMotion& result, const WindowMotion& expected, std::size_t k) {
  EXPECT_NEAR(result.u, expected.u, std::max(1e-4, 0.03 * expected.u_sd)) << k;
  EXPECT_NEAR(result.v, expected.v, std::max(1e-4, 0.03 * expected.v_sd)) << k;
  EXPECT_NEAR(result.ux, expected.ux, 2e-4) << k;
  EXPECT_NEAR(result.vx, expected.vx, 2e-4) << k;
  // The kernel's is the one before its last small step.
  EXPECT_NEAR(result.correlation, expected.correlation, 3e-4) << k;
  EXPECT_NEAR(result.u_sd, expected.u_sd, 0.02 * expected.u_sd) << k;
  EXPECT_NEAR(result.v_sd, expected.v_sd, 0.02 * expected.v_sd) << k;
}

TEST_P(Icgn, KernelGivesWhatTheReferenceGives) {
  const IcgnCase param = GetParam();
  opencl::Engine& engine = shared_engine();
  FieldOptions options;
  options.window_px = param.window_px;
  options.spline_degree = param.degree;
  const auto pictures = ball_frames(param.rotation_deg, 2);
  dic::DeviceFrames frames(engine, 3);
  dic::IcgnRefiner refiner(engine, options, 3, param.tiling);
  dic::IcgnReference reference(options, 3);
  for (int k = 0; k < 2; ++k) {
    frames.set(2 * k, pictures[static_cast<std::size_t>(k)]);
    reference.set_frame(2 * k, pictures[static_cast<std::size_t>(k)]);
  }
  // From the flat background over the rim onto the ball, and beyond the picture's border.
  auto windows = dic::rectangle_grid(-3, -5, kSize + 6, kSize + 9, param.window_px, 13);
  std::mt19937 random(1);
  std::vector<WindowMotion> seeds;
  for (Window& window : windows) {
    window.first = 0;
    window.second = 2;
    window.guess_rot_rad = static_cast<float>(param.guess_deg * M_PI / 180);
    seeds.push_back(seed_for(window, param.window_px, param.rotation_deg, random));
  }
  seeds[1].status = static_cast<idic_int>(WindowStatus::kAtSearchEdge);
  for (const bool masked : {false, true}) {
    if (masked) {
      refiner.set_disc(0, 79.3, 78.4, 66);
      reference.set_disc(0, 79.3, 78.4, 66);
    }
    const auto device_windows = opencl::make_buffer<Window>(engine, windows);
    std::vector<WindowMotion> canaries = seeds;
    canaries.resize(seeds.size() + 5, seeds[0]);
    auto motions = opencl::make_buffer<WindowMotion>(engine, canaries);
    refiner.refine(frames, device_windows, windows.size(), motions);
    const auto result = motions.to_vector(engine);
    int measured = 0, differing = 0;
    for (std::size_t k = 0; k < windows.size(); ++k) {
      const WindowMotion expected = reference.refine(windows[k], seeds[k]);
      // Without texture chance decides why a window fails; a window on the edge of a criterion
      // may fail in one of the two.
      const auto ok = static_cast<idic_int>(WindowStatus::kOk);
      differing += (result[k].status == ok) != (expected.status == ok);
      if (result[k].status != ok || expected.status != ok) continue;
      ++measured;
      expect_near(result[k], expected, k);
      EXPECT_EQ(result[k].peak_ratio, 3.0f);
    }
    EXPECT_GT(measured, param.window_px < 60 ? 20 : 1);
    EXPECT_LE(differing, static_cast<int>(windows.size()) / 100);
    EXPECT_EQ(result[1].status, static_cast<idic_int>(WindowStatus::kAtSearchEdge));
    for (std::size_t k = windows.size(); k < result.size(); ++k) {
      EXPECT_EQ(result[k].u, seeds[0].u);  // beyond `count` nothing is touched
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Cases, Icgn,
                         ::testing::Values(IcgnCase{15, 5, 0, 0}, IcgnCase{15, 5, 3, 0},
                                           IcgnCase{21, 3, 3, 3}, IcgnCase{31, 7, 3, 0},
                                           IcgnCase{16, 7, 40, 40}, IcgnCase{15, 5, 170, 170},
                                           IcgnCase{81, 3, 3, 0},
                                           IcgnCase{15, 5, 3, 0, dic::Tiling{1, 32}},
                                           IcgnCase{16, 3, 3, 0, dic::Tiling{8, 1}},
                                           IcgnCase{21, 3, 3, 3, dic::Tiling{4, 64}}));

// A ball that turned by 6° in one frame, its windows knowing nothing of it, those that the rim cuts
// included: every one is found, where the reference finds it.
TEST(IcgnCorrelator, FindsEveryWindowOfABallTheCutOnesToo) {
  SynthScene scene;
  scene.width = scene.height = 160;
  scene.noise_sigma = 2;
  const double turn = 6 * M_PI / 180;
  const auto pictures = testing::render_frames(testing::quick_ball(5, 70), scene,
                                               {pose(79.3, 78.4, 0), pose(80.67, 77.79, 6)});
  FieldOptions options;
  auto windows = dic::disc_grid(79.3, 78.4, 67, options.window_px, 11, 0.55);
  for (Window& window : windows) window.second = 1;
  const auto device = dic::make_opencl_correlator(shared_engine(), options, 2);
  const auto reference = dic::make_reference_correlator(options, 2);
  for (dic::Correlator* correlator : {device.get(), reference.get()}) {
    for (int k = 0; k < 2; ++k) correlator->set_frame(k, pictures[static_cast<std::size_t>(k)]);
    correlator->set_disc(0, 79.3, 78.4, 67);
  }
  const auto result = device->correlate(windows), expected = reference->correlate(windows);
  int cut = 0;
  for (std::size_t k = 0; k < windows.size(); ++k) {
    const double x = windows[k].x0 + 7 - 79.3, y = windows[k].y0 + 7 - 78.4;
    cut += std::hypot(std::abs(x) + 7, std::abs(y) + 7) > 67;
    ASSERT_EQ(result[k].status, static_cast<idic_int>(WindowStatus::kOk)) << k;
    ASSERT_EQ(expected[k].status, static_cast<idic_int>(WindowStatus::kOk)) << k;
    EXPECT_NEAR(result[k].u, expected[k].u, std::max(2e-4, 0.05 * expected[k].u_sd)) << k;
    EXPECT_NEAR(result[k].v, expected[k].v, std::max(2e-4, 0.05 * expected[k].v_sd)) << k;
    // Five standard deviations of the truth.
    const double c = std::cos(turn) - 1, s = std::sin(turn);
    EXPECT_NEAR(result[k].u, 80.67 - 79.3 + c * x + s * y, 5 * result[k].u_sd + 0.005) << k;
    EXPECT_NEAR(result[k].v, 77.79 - 78.4 - s * x + c * y, 5 * result[k].v_sd + 0.005) << k;
  }
  EXPECT_GT(cut, 10);
}

}  // namespace
}  // namespace impactdic
