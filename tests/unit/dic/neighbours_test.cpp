// The second chance of windows that were not found, with a refinement that needs a near seed.
#include "host/dic/neighbours.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>
#include <utility>

#include "host/base/statistics.h"

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
  motion.status = static_cast<idic_int>(WindowStatus::kOk);
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
    found[i] = near ? motion : lost(WindowStatus::kNotConverged);
  }
}

std::vector<Window> grid_of_pair(int first) {
  std::vector<Window> windows = dic::rectangle_grid(-40, 7, 300, 200, kSide, 8);
  for (Window& window : windows) {
    window.first = first;
    window.second = first + 1;
  }
  return windows;
}

TEST(Neighbours, SpreadFromOneWindowOverTheSurface) {
  const auto windows = grid_of_pair(0);
  std::vector<WindowMotion> motions(windows.size(), lost(WindowStatus::kAtSearchEdge));
  motions[100] = truth(windows[100], 0.9F);
  dic::Neighbours().refine_lost(windows, kSide, refine, motions);
  for (std::size_t i = 0; i < windows.size(); ++i) {
    ASSERT_EQ(motions[i].status, static_cast<idic_int>(WindowStatus::kOk)) << i;
    EXPECT_FLOAT_EQ(motions[i].u, truth(windows[i], 1).u);
  }
}

TEST(Neighbours, WhatHasNoTextureOrNoNeighboursStaysAsItIs) {
  auto windows = grid_of_pair(0);
  std::vector<WindowMotion> motions(windows.size(), lost(WindowStatus::kLowCorrelation));
  motions[0] = truth(windows[0], 0.9F);
  motions[5] = lost(WindowStatus::kNoTexture);
  motions[6] = lost(WindowStatus::kMasked);
  // Another pair of frames, of which nothing was found: the first pair is no neighbour of it.
  const auto others = grid_of_pair(1);
  windows.insert(windows.end(), others.begin(), others.end());
  motions.resize(windows.size(), lost(WindowStatus::kLowCorrelation));
  dic::Neighbours().refine_lost(windows, kSide, refine, motions);
  EXPECT_EQ(motions[5].status, static_cast<idic_int>(WindowStatus::kNoTexture));
  EXPECT_EQ(motions[6].status, static_cast<idic_int>(WindowStatus::kMasked));
  EXPECT_EQ(motions[7].status, static_cast<idic_int>(WindowStatus::kOk));
  for (std::size_t i = windows.size() - others.size(); i < windows.size(); ++i) {
    ASSERT_EQ(motions[i].status, static_cast<idic_int>(WindowStatus::kLowCorrelation));
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
  dic::Neighbours().refine_lost(windows, kSide, refine, motions);
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
  motions[wrong] = lost(WindowStatus::kLowCorrelation);
  std::size_t asked = 0;
  const dic::RefineWindows refine_wrongly_first = [&](std::span<const Window> some,
                                                      std::span<const WindowMotion> seeds,
                                                      std::span<WindowMotion> out) {
    refine(some, seeds, out);
    if (asked == 0) {
      out[0].u += 4;
      out[0].correlation = 0.7F;
    }
    asked += some.size();
  };
  dic::Neighbours().refine_lost(windows, kSide, refine_wrongly_first, motions);
  EXPECT_EQ(asked, 2);
  EXPECT_FLOAT_EQ(motions[wrong].u, truth(windows[wrong], 1).u);
}

// The last window of a row and the first of the next err together, far from each other: the second
// is suspected when the first has been corrected.
TEST(Neighbours, WrongWindowsThatAgreeAreReplaced) {
  const auto windows = grid_of_pair(0);
  std::vector<WindowMotion> motions;
  for (const Window& window : windows) motions.push_back(truth(window, 0.9F));
  std::size_t start = 100;
  while (windows[start].y0 == windows[start - 1].y0) ++start;
  for (const std::size_t i : {start - 1, start}) {
    motions[i].u += 4;
    motions[i].correlation = 0.7F;
  }
  dic::Neighbours().refine_lost(windows, kSide, refine, motions);
  for (const std::size_t i : {start - 1, start}) {
    EXPECT_FLOAT_EQ(motions[i].u, truth(windows[i], 1).u);
  }
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
    if (near) motions[i] = lost(WindowStatus::kMasked);
  }
  for (const std::size_t i : {bare, vain, alone}) motions[i] = lost(WindowStatus::kLowCorrelation);
  std::size_t asked = 0;
  const dic::RefineWindows refuse = [&](std::span<const Window> some,
                                        std::span<const WindowMotion> seeds,
                                        std::span<WindowMotion> out) {
    for (std::size_t k = 0; k < some.size(); ++k) {
      const bool is_bare = some[k].x0 == windows[bare].x0 && some[k].y0 == windows[bare].y0;
      const bool is_lost = seeds[k].status != static_cast<idic_int>(WindowStatus::kOk);
      out[k] = lost(is_bare || is_lost ? WindowStatus::kNoTexture : WindowStatus::kNotConverged);
      ++asked;
    }
  };
  dic::Neighbours neighbours;
  neighbours.refine_lost(windows, kSide, refuse, motions);
  EXPECT_EQ(asked, 2);
  EXPECT_EQ(motions[bare].status, static_cast<idic_int>(WindowStatus::kNoTexture));
  EXPECT_EQ(motions[alone].status, static_cast<idic_int>(WindowStatus::kLowCorrelation));
  neighbours.judge_lost(windows, std::vector{bare, vain, alone, found}, refuse, motions);
  EXPECT_EQ(asked, 3);
  EXPECT_EQ(motions[vain].status, static_cast<idic_int>(WindowStatus::kLowCorrelation));
  EXPECT_EQ(motions[alone].status, static_cast<idic_int>(WindowStatus::kNoTexture));
}

// The walk by its definition: every round looks at every window of one pair.
class PlainWalk {
 public:
  PlainWalk(std::span<const Window> windows, std::span<WindowMotion> motions)
      : windows_(windows), motions_(motions), tried_(windows.size()), challenged_(windows.size()) {
    for (const Window& window : windows) {
      left_ = std::min(left_, window.x0);
      top_ = std::min(top_, window.y0);
    }
  }
  void run(const dic::RefineWindows& refine) {
    for (bool any = true; any;) {
      any = false;
      std::vector<std::size_t> index;
      std::vector<Window> windows;
      std::vector<WindowMotion> seeds;
      for (std::size_t i = 0; i < windows_.size(); ++i) {
        if (!wants(i)) continue;
        index.push_back(i);
        windows.push_back(windows_[i]);
        seeds.push_back(seed(i, &windows.back()));
      }
      std::vector<WindowMotion> results(index.size());
      if (!index.empty()) refine(windows, seeds, results);
      for (std::size_t k = 0; k < index.size(); ++k) {
        WindowMotion& motion = motions_[index[k]];
        if (results[k].status != 0) continue;
        if (motion.status == 0 && results[k].correlation <= motion.correlation) continue;
        motion = results[k];
        any = true;
      }
    }
  }

 private:
  float u_of(std::size_t from, std::size_t to) const {
    const WindowMotion& m = motions_[from];
    const auto dx = static_cast<float>(windows_[to].x0 - windows_[from].x0);
    const auto dy = static_cast<float>(windows_[to].y0 - windows_[from].y0);
    return m.u + m.ux * dx + m.uy * dy;
  }
  float v_of(std::size_t from, std::size_t to) const {
    const WindowMotion& m = motions_[from];
    const auto dx = static_cast<float>(windows_[to].x0 - windows_[from].x0);
    const auto dy = static_cast<float>(windows_[to].y0 - windows_[from].y0);
    return m.v + m.vx * dx + m.vy * dy;
  }
  // All found ones near window i into near_, the nearest six; returns how many there are.
  std::size_t gather(std::size_t i) {
    std::vector<std::pair<int, std::size_t>> all;
    for (std::size_t k = 0; k < windows_.size(); ++k) {
      const int columns = (windows_[k].x0 - left_) / kSide - (windows_[i].x0 - left_) / kSide;
      const int rows = (windows_[k].y0 - top_) / kSide - (windows_[i].y0 - top_) / kSide;
      if (motions_[k].status != 0 || std::abs(columns) > 1 || std::abs(rows) > 1) continue;
      const int dx = windows_[k].x0 - windows_[i].x0, dy = windows_[k].y0 - windows_[i].y0;
      all.emplace_back(dx * dx + dy * dy, k);
    }
    std::ranges::sort(all);
    near_.clear();
    for (const auto& [distance2, k] : all) near_.push_back(k);
    near_.resize(std::min<std::size_t>(near_.size(), 6));
    return all.size();
  }
  bool wants(std::size_t i) {
    const std::size_t found = gather(i);
    if (motions_[i].status != 0) {
      const bool more = motions_[i].status == 3 && found > tried_[i];
      if (more) tried_[i] = found;
      return more;
    }
    if (challenged_[i] || !is_suspect(i)) return false;
    return challenged_[i] = true;
  }
  bool is_suspect(std::size_t i) {
    const auto differs = [&](float u, float v, float by) {
      return std::abs(u - motions_[i].u) > by || std::abs(v - motions_[i].v) > by;
    };
    const bool has_before = i > 0 && motions_[i - 1].status == 0;
    if (has_before && !differs(u_of(i - 1, i), v_of(i - 1, i), 0.5F)) return false;
    std::erase(near_, i);
    if (near_.size() < 3) return false;
    const WindowMotion middle = seed(i, nullptr);
    std::vector<float> apart;
    for (const std::size_t k : near_) {
      apart.push_back(std::max(std::abs(u_of(k, i) - middle.u), std::abs(v_of(k, i) - middle.v)));
    }
    return differs(middle.u, middle.v, 0.5F + 3 * upper_median(apart));
  }
  WindowMotion seed(std::size_t i, Window* window) const {
    std::vector<float> us, vs, turns;
    for (const std::size_t k : near_) {
      const WindowMotion& m = motions_[k];
      us.push_back(u_of(k, i));
      vs.push_back(v_of(k, i));
      turns.push_back((m.uy - m.vx) / (2 + m.ux + m.vy));
    }
    if (window != nullptr) window->guess_rot_rad = std::atan(upper_median(turns));
    WindowMotion start{};
    start.u = upper_median(us);
    start.v = upper_median(vs);
    return start;
  }

  std::span<const Window> windows_;
  std::span<WindowMotion> motions_;
  std::vector<std::size_t> tried_, near_;
  std::vector<bool> challenged_;
  int left_ = 1 << 20, top_ = 1 << 20;
};

// Fields of noise, with much lost and much gone astray, whose windows are found by chance, and not
// always at the same place.
TEST(Neighbours, SeeWhatTheWholeWalkSees) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> chance(0, 1);
  std::size_t asked = 0;
  const dic::RefineWindows refine_by_chance = [&asked](std::span<const Window> some,
                                                       std::span<const WindowMotion> seeds,
                                                       std::span<WindowMotion> out) {
    asked += some.size();
    for (std::size_t k = 0; k < some.size(); ++k) {
      // The same of the same.
      const auto place = static_cast<unsigned>(some[k].x0 * 911 + some[k].y0 * 77);
      std::mt19937 own(place ^ std::bit_cast<unsigned>(seeds[k].u));
      std::uniform_real_distribution<float> any(0, 1);
      out[k] = seeds[k];
      out[k].uy = std::tan(some[k].guess_rot_rad);
      out[k].vx = -out[k].uy;
      if (any(own) < 0.4F) out[k].u += 6 * any(own) - 3;
      out[k].correlation = any(own);
      if (any(own) < 0.3F) out[k] = lost(WindowStatus::kNotConverged);
    }
  };
  dic::Neighbours neighbours;
  for (int trial = 0; trial < 60; ++trial) {
    auto windows = dic::disc_grid(0, 0, 30 + trial % 5 * 10, kSide, 6 + trial % 4, 0.55);
    std::vector<WindowMotion> motions;
    for (Window& window : windows) {
      motions.push_back(truth(window, chance(random)));
      motions.back().uy += (trial % 2 == 0 ? 0.1F : 0.005F) * (chance(random) - 0.5F);
      if (chance(random) < 0.2F) motions.back().u += 4 * chance(random) - 2;
      if (chance(random) < 0.3F) motions.back() = lost(WindowStatus::kLowCorrelation);
      window.x0 += 100 + trial;
    }
    auto plain = motions;
    asked = 0;
    PlainWalk(windows, plain).run(refine_by_chance);
    const std::size_t asked_by_plain = std::exchange(asked, 0);
    neighbours.refine_lost(windows, kSide, refine_by_chance, motions);
    ASSERT_EQ(asked, asked_by_plain);
    for (std::size_t i = 0; i < windows.size(); ++i) {
      ASSERT_EQ(motions[i].status, plain[i].status) << i << " of trial " << trial;
      if (motions[i].status != 0) continue;
      ASSERT_EQ(motions[i].u, plain[i].u) << i << " of trial " << trial;
      ASSERT_EQ(motions[i].uy, plain[i].uy) << i << " of trial " << trial;
    }
  }
}

}  // namespace
}  // namespace impactdic
