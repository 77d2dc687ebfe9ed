// Windows that are followed: refined from where they are expected, searched for where that fails.
#include "host/dic/window_correlator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

#include "tests/support/engine.h"
#include "tests/support/speckle_frames.h"

namespace impactdic {
namespace {

constexpr double kRadiusPx = 60, kMiddlePx = 80;
constexpr double kDx = 2.3, kDy = -1.4;
constexpr double kBadDx = kDx + 6;  // beyond what IC-GN bridges, within the search

class Follow : public ::testing::Test {
 protected:
  Follow()
      : frames_(testing::shared_engine(), 2), windows_(testing::shared_engine(), options(), 2) {
    const auto pictures =
        testing::render_frames(testing::quick_ball(5, kRadiusPx), scene(),
                               {testing::pose(kMiddlePx, kMiddlePx, 0),
                                testing::pose(kMiddlePx + kDx, kMiddlePx + kDy, 0)});
    for (int slot = 0; slot < 2; ++slot) {
      frames_.set(slot, pictures[static_cast<std::size_t>(slot)]);
    }
    windows_.set_disc(0, kMiddlePx, kMiddlePx, kRadiusPx - 3);
    grid_ = dic::disc_grid(kMiddlePx, kMiddlePx, kRadiusPx - 3, options().window_px, 8);
    for (Window& window : grid_) {
      window.second = 1;
      window.guess_u = static_cast<int>(std::lround(kDx));
      window.guess_v = static_cast<int>(std::lround(kDy));
    }
  }

  static FieldOptions options() {
    FieldOptions options;
    options.method = FieldMethod::kIcgn;
    return options;
  }
  static SynthScene scene() {
    SynthScene scene;
    scene.width = scene.height = static_cast<int>(2 * kMiddlePx);
    scene.noise_sigma = 2;
    return scene;
  }
  std::vector<WindowMotion> seeds(double dx) const {
    return std::vector<WindowMotion>(grid_.size(), dic::seed_at(dx, kDy));
  }

  dic::DeviceFrames frames_;
  dic::WindowCorrelator windows_;
  std::vector<Window> grid_;
};

TEST_F(Follow, GivesWhatTheSearchGivesWithoutSearching) {
  const std::vector<WindowMotion> searched = windows_.correlate(frames_, grid_);
  const std::vector<WindowMotion> followed = windows_.follow(frames_, grid_, seeds(kDx + 0.05));
  std::size_t found = 0, not_searched = 0;
  for (std::size_t i = 0; i < grid_.size(); ++i) {
    ASSERT_EQ(followed[i].status, searched[i].status) << i;
    if (followed[i].status != static_cast<idic_int>(WindowStatus::kOk)) continue;
    ++found;
    not_searched += std::isnan(followed[i].peak_ratio) ? 1 : 0;
    EXPECT_NEAR(followed[i].u, searched[i].u, 2e-3) << i;
    EXPECT_NEAR(followed[i].v, searched[i].v, 2e-3) << i;
    EXPECT_NEAR(followed[i].u_sd, searched[i].u_sd, 0.02 * searched[i].u_sd) << i;
  }
  EXPECT_GT(found, grid_.size() * 9 / 10);
  EXPECT_EQ(not_searched, found);
}

TEST_F(Follow, SearchesForWhatIsNotWhereItWasExpected) {
  std::vector<WindowMotion> expected = seeds(kDx);
  for (std::size_t i = 0; i < grid_.size(); i += 2) expected[i] = dic::seed_at(kBadDx, kDy);
  const std::vector<WindowMotion>& followed = windows_.follow(frames_, grid_, expected);
  std::size_t found = 0;
  for (std::size_t i = 0; i < grid_.size(); ++i) {
    if (followed[i].status != static_cast<idic_int>(WindowStatus::kOk)) continue;
    ++found;
    EXPECT_NEAR(followed[i].u, kDx, 0.1) << i;
    EXPECT_NEAR(followed[i].v, kDy, 0.1) << i;
  }
  EXPECT_GT(found, grid_.size() * 9 / 10);
}

// A processor gets some thousands at a time: the bits are those of windows measured in any parts.
TEST_F(Follow, ManyWindowsInPartsHaveTheSameBits) {
  const double pixels = static_cast<double>(options().window_px) * options().window_px;
  std::vector<Window> many;
  while (many.size() < 6000) many.insert(many.end(), grid_.begin(), grid_.end());
  if (!testing::shared_engine().device().is_gpu) {
    ASSERT_LT(testing::shared_engine().at_once(many.size(), pixels), many.size());
  }
  const std::vector<WindowMotion> whole = windows_.find(frames_, many);
  constexpr std::size_t kPart = 1000;
  for (std::size_t first = 0; first < many.size(); first += kPart) {
    const std::size_t count = std::min(kPart, many.size() - first);
    const auto& part = windows_.find(frames_, std::span(many).subspan(first, count));
    for (std::size_t i = 0; i < count; ++i) {
      const WindowMotion &a = part[i], &b = whole[first + i];
      ASSERT_EQ(a.status, b.status) << first + i;
      ASSERT_EQ(std::bit_cast<std::uint32_t>(a.u), std::bit_cast<std::uint32_t>(b.u)) << first + i;
      ASSERT_EQ(std::bit_cast<std::uint32_t>(a.v), std::bit_cast<std::uint32_t>(b.v)) << first + i;
    }
  }
}

TEST_F(Follow, EveryWindowNeedsASeed) {
  EXPECT_THROW(windows_.follow(frames_, grid_, {}), InvalidArgument);
}

}  // namespace
}  // namespace impactdic
