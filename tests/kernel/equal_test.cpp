// Equal windows on the device against their double-precision reference.
#include "host/dic/device/equal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <set>

#include "host/benchmark/equal_stream.h"
#include "host/dic/correlator.h"
#include "host/dic/device/tuning.h"
#include "host/dic/reference/equal.h"
#include "sim/speckle/speckle_field.h"
#include "tests/support/engine.h"

namespace impactdic {
namespace {

using testing::shared_engine;

constexpr int kWidth = 141, kHeight = 123;

const sim::speckle::SpeckleField& field() {
  static const sim::speckle::SpeckleField surface(1500, 160, 1.5, 3);
  return surface;
}

struct Case {
  int window_px, bits, count;
  bool every_variant;  // compiling them takes its time
};

std::vector<dic::EqualVariant> variants_of(const Case& c) {
  auto variants = dic::equal_variants(shared_engine().device(), c.window_px);
  if (!c.every_variant) variants.resize(1);
  // Without matrix units: the same kernel but for how it multiplies.
  if (c.window_px == 32) variants.push_back({1, 32, 1, true, false, 0, true});
  return variants;
}

class Equal : public ::testing::TestWithParam<Case> {};

// Odd and even counts, one window, windows across the edge, flat ones, and other surfaces.
TEST_P(Equal, VariantsAgreeWithTheReference) {
  const Case& c = GetParam();
  opencl::Engine& engine = shared_engine();
  FieldOptions options;
  options.window_px = c.window_px;
  options.min_correlation = 0.2;
  std::vector<Frame> clip = {field().render(kWidth, kHeight, 0, 0, 0, 0, 0, c.bits, 2, 1),
                             field().render(kWidth, kHeight, 2.3, -0.6, 0, 0, 0, c.bits, 2, 2),
                             field().render(kWidth, kHeight, 0, 0, 0, 0, 0, c.bits, 0, 1)};
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) {
      if (c.bits == 8) clip[2].u8(x, y) = 137;
      if (c.bits > 8) clip[2].u16(x, y) = 1370;
    }
  }
  std::mt19937 random(11);
  std::uniform_int_distribution<int> x(-2, kWidth - c.window_px + 2);
  std::uniform_int_distribution<int> y(-2, kHeight - c.window_px + 2), off(-2, 2);
  std::vector<Window> windows;
  for (int i = 0; i < c.count; ++i) {
    windows.push_back({i % 5 == 4 ? 2 : 0, 1, x(random), y(random), off(random), off(random), 0});
  }
  windows[0] = {0, 1, 50, 50, 0, 0, 0};
  if (c.count > 2) windows[1] = {2, 1, 3, 2, 0, 0, 0};
  std::vector<Image<float>> pictures;
  dic::DeviceFrames frames(engine, 3);
  for (int k = 0; k < 3; ++k) {
    frames.set(k, clip[static_cast<std::size_t>(k)]);
    pictures.push_back(clip[static_cast<std::size_t>(k)].to_float());
  }
  const auto input = opencl::make_buffer<Window>(engine, windows);
  for (const dic::EqualVariant& variant : variants_of(c)) {
    SCOPED_TRACE(variant.name());
    WindowMotion canary{};
    canary.u = -77;
    auto output = opencl::make_buffer<WindowMotion>(
        engine, std::vector<WindowMotion>(windows.size() + 5, canary));
    dic::EqualOpencl(engine, options, variant).run(frames, input, windows.size(), output);
    const auto motions = output.to_vector(engine);
    for (std::size_t i = windows.size(); i < motions.size(); ++i) EXPECT_EQ(motions[i].u, -77);
    int ok = 0;
    for (std::size_t i = 0; i < windows.size(); ++i) {
      const auto& first = pictures[static_cast<std::size_t>(windows[i].first)];
      const WindowMotion expected = dic::equal_reference(first.view(), pictures[1].view(),
                                                         windows[i], options, clip[0].full_scale());
      ASSERT_EQ(motions[i].status, expected.status) << i;
      if (expected.status != static_cast<int>(WindowStatus::kOk)) continue;
      ++ok;
      EXPECT_NEAR(motions[i].u, expected.u, 1e-4) << i;
      EXPECT_NEAR(motions[i].v, expected.v, 1e-4) << i;
      EXPECT_NEAR(motions[i].correlation, expected.correlation, 1e-5) << i;
      EXPECT_NEAR(motions[i].u_sd, expected.u_sd, 1e-4) << i;
      EXPECT_NEAR(motions[i].v_sd, expected.v_sd, 1e-4) << i;
    }
    EXPECT_GT(2 * ok, c.count);
    if (c.count > 2) {
      EXPECT_EQ(motions[1].status, static_cast<int>(WindowStatus::kNoTexture));
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Sizes, Equal,
                         ::testing::Values(Case{32, 8, 37, false}, Case{32, 12, 5, false},
                                           Case{16, 12, 1, false}, Case{16, 8, 64, true}));

// Lists of windows after each other: most begin where those of the list before end, so that a group
// of a GPU's variant need not transform them again; some do not.
TEST(Equal, WindowsOfAClipAreThoseOfItsPairs) {
  opencl::Engine& engine = shared_engine();
  FieldOptions options;
  options.window_px = 16;
  options.min_correlation = 0.2;
  dic::DeviceFrames frames(engine, 6);
  for (int k = 0; k < 6; ++k) {
    frames.set(k, field().render(kWidth, kHeight, 1.3 * k, -0.7 * k, 0, 0, 0, 8, 2,
                                 static_cast<unsigned>(k + 1)));
  }
  const auto grid = dic::rectangle_grid(20, 20, 64, 48, 16, 8);
  const std::size_t period = grid.size();
  ASSERT_EQ(period % 2, 1U) << "a list's last window has no partner";
  std::vector<Window> windows;
  for (int pair = 0; pair < 5; ++pair) {
    for (Window window : grid) {
      const bool jumps = pair == 3 && windows.size() % 4 == 0;
      window.first = jumps ? 0 : pair;
      window.second = pair + 1;
      // Another guess moves the second window away from where the next list has its first.
      window.guess_u = windows.size() % 11 == 0 ? 2 : 0;
      windows.push_back(window);
    }
  }
  windows.resize(windows.size() - 4);
  const auto input = opencl::make_buffer<Window>(engine, windows);
  // As the one that a CPU offers, so that the program is there already.
  const dic::EqualVariant variant{1, 16, 2, true, false, 0};
  const auto measure = [&](std::size_t of) {
    opencl::Buffer<WindowMotion> output(engine, windows.size());
    dic::EqualOpencl(engine, options, variant).run(frames, input, windows.size(), output, of);
    return output.to_vector(engine);
  };
  const auto apart = measure(0), followed = measure(period);
  int ok = 0;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    ASSERT_EQ(followed[i].status, apart[i].status) << i;
    if (apart[i].status != static_cast<int>(WindowStatus::kOk)) continue;
    ++ok;
    EXPECT_NEAR(followed[i].u, apart[i].u, 1e-5) << i;
    EXPECT_NEAR(followed[i].v, apart[i].v, 1e-5) << i;
    EXPECT_NEAR(followed[i].u_sd, apart[i].u_sd, 1e-5) << i;
  }
  EXPECT_GT(ok, 100);
}

// Batches of a stream, two under way at a time, give what their pictures give one after the other.
TEST(EqualStream, EveryBatchGetsItsOwnPicturesMotions) {
  opencl::Engine& engine = shared_engine();
  FieldOptions options;
  options.window_px = 16;
  options.min_correlation = 0.2;
  std::vector<Frame> clip;
  for (int k = 0; k < 5; ++k) {
    clip.push_back(field().render(kWidth, kHeight, 0.9 * k * k, -0.7 * k, 0, 0, 0, 8, 2,
                                  static_cast<unsigned>(k + 1)));
  }
  std::vector<Window> windows = dic::rectangle_grid(10, 10, 80, 60, 16, 16);
  for (Window& window : windows) window.second = 1;
  const auto expected = [&](std::size_t first) {
    dic::DeviceFrames frames(engine, 2);
    frames.set(0, clip[first]);
    frames.set(1, clip[first + 1]);
    opencl::Buffer<WindowMotion> motions(engine, windows.size());
    dic::EqualOpencl(engine, options, dic::choose_equal_variant(engine, 16))
        .run(frames, opencl::make_buffer<Window>(engine, windows), windows.size(), motions);
    return motions.to_vector(engine);
  };
  benchmark::EqualStream stream(engine, options, {kWidth, kHeight, PixelType::kU8, 255, 2, 0},
                                windows, 2);
  const auto start = [&](int worker, std::size_t first) {
    const auto bytes = stream.pictures(worker);
    ASSERT_EQ(bytes.size(), 2 * clip[0].byte_count());
    for (std::size_t k = 0; k < 2; ++k) {
      std::memcpy(bytes.data() + k * clip[0].byte_count(), clip[first + k].bytes(),
                  clip[0].byte_count());
    }
    stream.start(worker);
  };
  const auto check = [&](int worker, std::size_t first) {
    SCOPED_TRACE(first);
    const auto wanted = expected(first);
    const auto got = stream.wait(worker);
    ASSERT_EQ(got.size(), wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      ASSERT_EQ(got[i].status, wanted[i].status) << i;
      if (wanted[i].status != static_cast<int>(WindowStatus::kOk)) continue;
      EXPECT_EQ(got[i].u, wanted[i].u) << i;
      EXPECT_EQ(got[i].v, wanted[i].v) << i;
    }
  };
  start(0, 0);
  start(1, 1);
  check(0, 0);
  start(0, 2);
  check(1, 1);
  start(1, 3);
  check(1, 3);
  check(0, 2);
  windows.back().second = 2;
  EXPECT_THROW(benchmark::EqualStream(engine, options, {kWidth, kHeight, PixelType::kU8, 255, 2, 0},
                                      windows, 1),
               InvalidArgument);
}

// `--method equal`, device and reference through the interface that every method has.
std::vector<WindowMotion> measure_as_method(dic::Correlator& correlator, const Frame& first,
                                            const Frame& second,
                                            const std::vector<Window>& windows) {
  correlator.set_frame(0, first);
  correlator.set_frame(1, second);
  correlator.set_disc(0, 70, 60, 30);  // no matter to this method
  return correlator.correlate(windows);
}

TEST(EqualMethod, AgreesWithTheReferenceWindowByWindow) {
  FieldOptions options;
  options.method = FieldMethod::kEqual;
  options.window_px = 16;
  options.min_correlation = 0.6;
  Frame first = field().render(kWidth, kHeight, 0, 0, 0, 0, 0, 8, 2, 1);
  const Frame second = field().render(kWidth, kHeight, 3.3, -2.6, 0, 0, 0, 8, 2, 2);
  for (int y = 60; y < 90; ++y) {
    for (int x = 60; x < 90; ++x) first.u8(x, y) = 137;
  }
  std::vector<Window> windows;
  std::set<int> statuses;
  for (Window window : dic::rectangle_grid(0, 0, kWidth, kHeight, 16, 7)) {
    window.second = 1;
    // With the right guess, none, and one so wrong that other speckles lie there.
    const std::size_t k = windows.size() % 3;
    window.guess_u = k == 0 ? 3 : k == 1 ? 0 : 30;
    window.guess_v = k == 0 ? -3 : 0;
    windows.push_back(window);
  }
  const auto device = dic::make_opencl_correlator(shared_engine(), options, 2);
  const auto reference = dic::make_reference_correlator(options, 2);
  const auto got = measure_as_method(*device, first, second, windows);
  const auto want = measure_as_method(*reference, first, second, windows);
  ASSERT_EQ(got.size(), want.size());
  for (std::size_t i = 0; i < got.size(); ++i) {
    ASSERT_EQ(got[i].status, want[i].status) << i;
    statuses.insert(got[i].status);
    if (got[i].status != static_cast<int>(WindowStatus::kOk)) {
      EXPECT_TRUE(std::isnan(got[i].u) && std::isnan(got[i].u_sd)) << i;
      continue;
    }
    EXPECT_NEAR(got[i].u, want[i].u, 1e-4) << i;
    EXPECT_NEAR(got[i].v, want[i].v, 1e-4) << i;
    EXPECT_NEAR(got[i].u_sd, want[i].u_sd, 1e-4) << i;
  }
  for (const auto status : {WindowStatus::kOk, WindowStatus::kNoTexture,
                            WindowStatus::kLowCorrelation, WindowStatus::kOutOfView}) {
    EXPECT_EQ(statuses.count(static_cast<int>(status)), 1U) << to_string(status);
  }
}

// What leaves a window of its displacement is lost to it: the scatter falls when the guess is near.
TEST(EqualMethod, ErrsLessTheNearerTheGuess) {
  FieldOptions options;
  options.method = FieldMethod::kEqual;
  options.window_px = 32;
  options.min_correlation = 0.3;
  constexpr double kShift = 6.4;
  const Frame first = field().render(kWidth, kHeight, 0, 0);
  const Frame second = field().render(kWidth, kHeight, kShift, 0);
  const auto correlator = dic::make_opencl_correlator(shared_engine(), options, 2);
  struct Errors {
    double mean = 0, rms = 0;
  };
  const auto errors = [&](int guess) {
    std::vector<Window> windows = dic::rectangle_grid(0, 0, kWidth - 16, kHeight, 32, 8);
    for (Window& window : windows) {
      window.second = 1;
      window.guess_u = guess;
    }
    double sum = 0, squares = 0;
    int ok = 0;
    for (const WindowMotion& motion : measure_as_method(*correlator, first, second, windows)) {
      if (motion.status != static_cast<int>(WindowStatus::kOk)) continue;
      const double error = motion.u - kShift;
      sum += error;
      squares += error * error;
      ++ok;
    }
    EXPECT_GT(ok, static_cast<int>(windows.size()) * 9 / 10);
    return Errors{sum / ok, std::sqrt(squares / ok)};
  };
  const Errors far = errors(0), near = errors(6);
  std::printf("equal 32: unguessed mean %.4f rms %.4f px, guessed mean %.4f rms %.4f px\n",
              far.mean, far.rms, near.mean, near.rms);
  EXPECT_LT(near.rms, 0.5 * far.rms);
  EXPECT_LT(std::abs(far.mean), 0.05);
  EXPECT_LT(std::abs(near.mean), 0.05);
}

TEST(EqualMethod, SaysWhichWindowsThereAreAndThatAPictureIsTooSmall) {
  FieldOptions options;
  options.method = parse_field_method("equal");
  EXPECT_THROW(options.validate(), InvalidArgument);  // 15 px
  options.window_px = 32;
  EXPECT_NO_THROW(options.validate());
  const auto correlator = dic::make_opencl_correlator(shared_engine(), options, 2);
  const Frame small = field().render(31, 64, 0, 0);
  const auto motions = measure_as_method(*correlator, small, small, {{0, 1, 0, 0, 0, 0, 0}});
  ASSERT_EQ(motions.size(), 1U);
  EXPECT_EQ(motions[0].status, static_cast<int>(WindowStatus::kOutOfView));
}

TEST(Equal, RefusesOtherSizesAndTooSmallPictures) {
  opencl::Engine& engine = shared_engine();
  FieldOptions options;
  options.window_px = 24;
  const dic::EqualVariant variant = dic::equal_variants(engine.device(), 32).front();
  EXPECT_THROW(dic::EqualOpencl(engine, options, variant), InvalidArgument);
  options.window_px = 32;
  dic::DeviceFrames frames(engine, 2);
  frames.set(0, field().render(31, 64, 0, 0));
  frames.set(1, field().render(31, 64, 0, 0));
  opencl::Buffer<Window> windows(engine, 1);
  opencl::Buffer<WindowMotion> motions(engine, 1);
  dic::EqualOpencl equal(engine, options, variant);
  EXPECT_THROW(equal.run(frames, windows, 1, motions), InvalidArgument);
}

}  // namespace
}  // namespace impactdic
