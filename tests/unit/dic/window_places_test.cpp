// Windows by place: who is near in a grid, and who is whole on a disc.
#include "host/dic/window_places.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>

#include "host/dic/discs.h"

namespace impactdic {
namespace {

constexpr int kSide = 15;
using Index = dic::WindowPlaces::Index;

// By the definition: those in the 3 × 3 bins about the window's own, nearest first.
std::vector<Index> nearest_of(const std::vector<Window>& windows, Index i,
                              const std::vector<std::uint8_t>& state) {
  const auto first = [](int Window::*of) {
    return [of](const Window& a, const Window& b) { return a.*of < b.*of; };
  };
  const int left = std::ranges::min_element(windows, first(&Window::x0))->x0;
  const int top = std::ranges::min_element(windows, first(&Window::y0))->y0;
  const auto column = [&](Index k) { return (windows[k].x0 - left) / kSide; };
  const auto row = [&](Index k) { return (windows[k].y0 - top) / kSide; };
  std::vector<std::tuple<int, Index>> near;
  for (Index k = 0; k < windows.size(); ++k) {
    if (std::abs(column(k) - column(i)) > 1 || std::abs(row(k) - row(i)) > 1) continue;
    const int dx = windows[k].x0 - windows[i].x0, dy = windows[k].y0 - windows[i].y0;
    if (state[k] % 2 == 1) near.emplace_back(dx * dx + dy * dy, k);
  }
  std::ranges::sort(near);
  std::vector<Index> index;
  for (const auto& [distance2, k] : near) index.push_back(k);
  index.resize(std::min(index.size(), dic::WindowPlaces::kNearest));
  return index;
}

// The densest grid has 225 windows about each, of which few are found.
TEST(WindowPlaces, NearestAreThoseOfTheNineBins) {
  std::mt19937 random(1);
  for (const int spacing : {3, 8, 20}) {
    const auto windows = dic::rectangle_grid(-31, 12, 130, 100, kSide, spacing);
    dic::WindowPlaces places(windows, kSide);
    for (const unsigned one_in : {1, 3, 60}) {
      std::vector<std::uint8_t> state(windows.size());
      for (auto& own : state) own = static_cast<std::uint8_t>(random() % one_in == 0 ? 5 : 6);
      for (Index i = 0; i < windows.size(); ++i) {
        dic::WindowPlaces::Nearest near;
        places.find_nearest(i, state, near);
        const std::vector<Index> found(near.index.begin(), near.index.begin() + near.count);
        ASSERT_EQ(found, nearest_of(windows, i, state)) << i << " spacing " << spacing;
      }
    }
  }
}

TEST(WindowPlaces, ChangesReachTheNineBins) {
  const auto windows = dic::disc_grid(0, 0, 60, kSide, 8);
  dic::WindowPlaces places(windows, kSide);
  const std::vector<std::uint8_t> all(windows.size(), 1);
  for (Index i = 0; i < windows.size(); ++i) {
    std::vector<std::uint8_t> bins(places.bins(), 0);
    places.mark_near(i, 7, bins);
    for (Index k = 0; k < windows.size(); ++k) {
      // Who is near i, has i near itself.
      std::vector<std::uint8_t> alone(windows.size(), 0);
      alone[i] = 1;
      ASSERT_EQ(bins[places.bin(k)] == 7, !nearest_of(windows, k, alone).empty());
    }
  }
}

TEST(WindowPlaces, KnowAPairOfTheSameGrid) {
  auto windows = dic::disc_grid(0, 0, 60, kSide, 8);
  const dic::WindowPlaces places(windows, kSide);
  const std::size_t count = windows.size();
  for (Window& window : windows) {
    window.x0 += 40;
    window.second = 1;
  }
  EXPECT_TRUE(places.lead(windows, kSide));
  EXPECT_FALSE(places.lead(windows, kSide + 2));
  EXPECT_FALSE(places.lead(std::span(windows).first(count - 1), kSide));
  windows.push_back(windows.back());
  EXPECT_FALSE(places.lead(windows, kSide)) << "the pair has one more";
  windows.back().second = 2;
  EXPECT_TRUE(places.lead(windows, kSide)) << "that one is of the next pair";
  windows[count - 1].first = 3;
  EXPECT_FALSE(places.lead(windows, kSide)) << "two pairs";
  windows[count - 1].first = 0;
  windows[5].y0 += 1;
  EXPECT_FALSE(places.lead(windows, kSide));
}

// Every window's result names its window.
TEST(WholeWindows, ResultsStandAtTheirWindows) {
  constexpr int kNumber = 1000;
  dic::Discs discs(2);
  discs.set(0, 50.25, 49.5, 45);
  std::vector<Window> windows;
  for (const int slot : {0, 1, 0}) {
    for (Window window : dic::rectangle_grid(0, 0, 100, 100, kSide, 8)) {
      window.first = slot;
      window.guess_u = static_cast<idic_int>(windows.size());
      windows.push_back(window);
    }
  }
  std::vector<WindowMotion> motions(windows.size());
  dic::WholeWindows whole;
  std::size_t searched = 0;
  const auto search = [&](std::span<const Window> some, std::span<WindowMotion> found) {
    ASSERT_EQ(some.size(), found.size());
    searched = some.size();
    for (std::size_t k = 0; k < some.size(); ++k) {
      found[k] = {};
      found[k].u = static_cast<float>(kNumber + some[k].guess_u);
    }
  };
  whole.search(windows, kSide, discs, WindowStatus::kMasked, motions, search);
  std::vector<std::size_t> cut;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const Window& window = windows[i];
    bool is_cut = false;
    for (const int x : {window.x0, window.x0 + kSide - 1}) {
      for (const int y : {window.y0, window.y0 + kSide - 1}) {
        is_cut = is_cut || (window.first == 0 && std::hypot(x - 50.25, y - 49.5) > 45);
      }
    }
    if (is_cut) cut.push_back(i);
    ASSERT_EQ(motions[i].status, is_cut ? static_cast<idic_int>(WindowStatus::kMasked) : 0) << i;
    ASSERT_EQ(std::isnan(motions[i].u), is_cut) << i;
    if (is_cut) continue;
    ASSERT_EQ(motions[i].u, static_cast<float>(kNumber + i));
  }
  EXPECT_EQ(searched + cut.size(), windows.size());
  EXPECT_GT(cut.size(), 50);
  EXPECT_TRUE(std::ranges::equal(whole.cut(), cut));
}

}  // namespace
}  // namespace impactdic
