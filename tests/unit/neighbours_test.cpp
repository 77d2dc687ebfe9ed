// The second chance of windows that were not found, with a refinement that needs a near seed.
#include "host/dic/neighbours.h"

#include <gtest/gtest.h>

#include <cmath>

namespace impactdic {
namespace {

constexpr int kSide = 15;

// A surface that turns and stretches: displacement and gradient at (x, y).
WindowMotion truth(const Window& window, float correlation) {
  const float x = static_cast<float>(window.x0), y = static_cast<float>(window.y0);
  WindowMotion motion{};
  motion.ux = 0.02F;
  motion.uy = 0.05F;
  motion.vx = -0.05F;
  motion.vy = -0.01F;
  motion.u = 3 + motion.ux * x + motion.uy * y;
  motion.v = -1 + motion.vx * x + motion.vy * y;
  motion.correlation = correlation;
  motion.status = static_cast<idic_int>(WindowStatus::ok);
  return motion;
}

WindowMotion lost(WindowStatus status) {
  WindowMotion motion{};
  motion.u = motion.v = NAN;
  motion.status = static_cast<idic_int>(status);
  return motion;
}

// Finds the truth from a seed within 1 px of it.
void refine(std::span<const Window> windows, std::span<const WindowMotion> seeds,
            std::span<WindowMotion> found) {
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const WindowMotion motion = truth(windows[i], 0.95F);
    const bool near = std::hypot(seeds[i].u - motion.u, seeds[i].v - motion.v) < 1;
    found[i] = near ? motion : lost(WindowStatus::not_converged);
  }
}

std::vector<Window> grid_of_pair(int first) {
  std::vector<Window> windows = rectangle_grid(-40, 7, 300, 200, kSide, 8);
  for (Window& window : windows) {
    window.first = first;
    window.second = first + 1;
  }
  return windows;
}

TEST(Neighbours, SpreadFromOneWindowOverTheSurface) {
  const auto windows = grid_of_pair(0);
  std::vector<WindowMotion> motions(windows.size(), lost(WindowStatus::at_search_edge));
  motions[100] = truth(windows[100], 0.9F);
  Neighbours().refine_lost(windows, kSide, refine, motions);
  for (std::size_t i = 0; i < windows.size(); ++i) {
    ASSERT_EQ(motions[i].status, static_cast<idic_int>(WindowStatus::ok)) << i;
    EXPECT_FLOAT_EQ(motions[i].u, truth(windows[i], 1).u);
  }
}

TEST(Neighbours, WhatHasNoTextureOrNoNeighboursStaysAsItIs) {
  auto windows = grid_of_pair(0);
  std::vector<WindowMotion> motions(windows.size(), lost(WindowStatus::low_correlation));
  motions[0] = truth(windows[0], 0.9F);
  motions[5] = lost(WindowStatus::no_texture);
  motions[6] = lost(WindowStatus::masked);
  // Another pair of frames, of which nothing was found: the first pair is no neighbour of it.
  const auto others = grid_of_pair(1);
  windows.insert(windows.end(), others.begin(), others.end());
  motions.resize(windows.size(), lost(WindowStatus::low_correlation));
  Neighbours().refine_lost(windows, kSide, refine, motions);
  EXPECT_EQ(motions[5].status, static_cast<idic_int>(WindowStatus::no_texture));
  EXPECT_EQ(motions[6].status, static_cast<idic_int>(WindowStatus::masked));
  EXPECT_EQ(motions[7].status, static_cast<idic_int>(WindowStatus::ok));
  for (std::size_t i = windows.size() - others.size(); i < windows.size(); ++i) {
    ASSERT_EQ(motions[i].status, static_cast<idic_int>(WindowStatus::low_correlation));
  }
}

TEST(Neighbours, WrongWindowIsReplacedUnlessItCorrelatesBetter) {
  const auto windows = grid_of_pair(0);
  std::vector<WindowMotion> motions;
  for (const Window& window : windows) motions.push_back(truth(window, 0.9F));
  motions[80].u += 4;
  motions[80].correlation = 0.7F;
  motions[150].v -= 3;
  motions[150].correlation = 0.99F;
  Neighbours().refine_lost(windows, kSide, refine, motions);
  EXPECT_FLOAT_EQ(motions[80].u, truth(windows[80], 1).u);
  EXPECT_FLOAT_EQ(motions[80].correlation, 0.95F);
  EXPECT_FLOAT_EQ(motions[150].correlation, 0.99F);
  EXPECT_FLOAT_EQ(motions[79].correlation, 0.9F);  // those that agree are left alone
}

// A lost window is found wrongly: a later round asks for it again, and for no other.
TEST(Neighbours, WhatWasFoundIsSuspectedToo) {
  const auto windows = grid_of_pair(0);
  const std::size_t wrong = 120;
  std::vector<WindowMotion> motions;
  for (const Window& window : windows) motions.push_back(truth(window, 0.9F));
  motions[wrong] = lost(WindowStatus::low_correlation);
  std::size_t asked = 0;
  const RefineWindows refine_wrongly_first = [&](std::span<const Window> some,
                                                 std::span<const WindowMotion> seeds,
                                                 std::span<WindowMotion> out) {
    refine(some, seeds, out);
    if (asked == 0) {
      out[0].u += 4;
      out[0].correlation = 0.7F;
    }
    asked += some.size();
  };
  Neighbours().refine_lost(windows, kSide, refine_wrongly_first, motions);
  EXPECT_EQ(asked, 2);
  EXPECT_FLOAT_EQ(motions[wrong].u, truth(windows[wrong], 1).u);
}

// Of the windows that are to be judged, one has been refined and was found to have no texture, one
// was refined in vain, one has no neighbour, and one is found.
TEST(Neighbours, TextureIsJudgedOnce) {
  const auto windows = grid_of_pair(0);
  const std::size_t bare = 100, vain = 300, alone = windows.size() - 1, found = 50;
  std::vector<WindowMotion> motions;
  for (const Window& window : windows) motions.push_back(truth(window, 0.9F));
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const bool near = std::abs(windows[i].x0 - windows[alone].x0) < 3 * kSide &&
                      std::abs(windows[i].y0 - windows[alone].y0) < 3 * kSide;
    if (near) motions[i] = lost(WindowStatus::masked);
  }
  for (const std::size_t i : {bare, vain, alone}) motions[i] = lost(WindowStatus::low_correlation);
  std::size_t asked = 0;
  const RefineWindows refuse = [&](std::span<const Window> some,
                                   std::span<const WindowMotion> seeds,
                                   std::span<WindowMotion> out) {
    for (std::size_t k = 0; k < some.size(); ++k) {
      const bool is_bare = some[k].x0 == windows[bare].x0 && some[k].y0 == windows[bare].y0;
      const bool is_lost = seeds[k].status != static_cast<idic_int>(WindowStatus::ok);
      out[k] = lost(is_bare || is_lost ? WindowStatus::no_texture : WindowStatus::not_converged);
      ++asked;
    }
  };
  Neighbours neighbours;
  neighbours.refine_lost(windows, kSide, refuse, motions);
  EXPECT_EQ(asked, 2);
  EXPECT_EQ(motions[bare].status, static_cast<idic_int>(WindowStatus::no_texture));
  EXPECT_EQ(motions[alone].status, static_cast<idic_int>(WindowStatus::low_correlation));
  neighbours.judge_lost(windows, std::vector{bare, vain, alone, found}, refuse, motions);
  EXPECT_EQ(asked, 3);
  EXPECT_EQ(motions[vain].status, static_cast<idic_int>(WindowStatus::low_correlation));
  EXPECT_EQ(motions[alone].status, static_cast<idic_int>(WindowStatus::no_texture));
}

}  // namespace
}  // namespace impactdic
