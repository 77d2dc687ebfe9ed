#include "host/camera/calibrate/dot_lattice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>

#include "tests/support/camera/rendered_calibration.h"

namespace impactdic {
namespace {

using Eigen::Vector2d;

// Dots of which the picture's border cuts off some, in any order, with other blobs among them.
struct Seen {
  std::vector<Vector2d> centres;
  std::vector<std::size_t> points;  // of the target; none of what is no dot
};

constexpr std::size_t kNoDot = 10000;

Seen seen_by(const Camera& camera, const CalibrateRequest& request, unsigned seed) {
  Seen seen;
  const auto exact = testing::project_target(camera, camera::board_points(request));
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 0.2);
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const double down = noise(random), aside = noise(random);
    const Vector2d at = exact[i] + Vector2d(aside, down);
    if (at.x() < 60 || at.x() > camera.width - 30 || at.y() < 40) continue;
    if (i % 17 == 3) continue;  // a dot that no finder took
    seen.centres.push_back(at);
    seen.points.push_back(i);
  }
  for (int i = 0; i < 4; ++i) {
    seen.centres.emplace_back(5 + 9 * i, 7 + 8 * i);
    seen.points.push_back(kNoDot);
  }
  std::vector<std::size_t> order(seen.centres.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), random);
  Seen mixed;
  for (const std::size_t i : order) {
    mixed.centres.push_back(seen.centres[i]);
    mixed.points.push_back(seen.points[i]);
  }
  return mixed;
}

TEST(DotLattice, APartOfTheTargetIsNumberedButForAShift) {
  const CalibrateRequest request = testing::rendered_target(CalibrationTarget::kDots);
  const int columns = request.columns;
  int pictures = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    for (const Camera& camera : testing::random_calibration(request, 6, seed).views) {
      const Seen seen = seen_by(camera, request, seed);
      const auto dots = static_cast<std::size_t>(
          std::count_if(seen.points.begin(), seen.points.end(),
                        [](std::size_t point) { return point != kNoDot; }));
      if (dots < 20) continue;
      const auto numbered = camera::number_dots(seen.centres, request.columns, request.rows);
      EXPECT_GE(numbered.size(), dots - 2) << seed;
      ++pictures;
      std::optional<Vector2d> shift;
      for (const camera::Sighting& one : numbered) {
        const auto at = std::find(seen.centres.begin(), seen.centres.end(), one.at_px);
        const std::size_t truth = seen.points[static_cast<std::size_t>(at - seen.centres.begin())];
        ASSERT_NE(truth, kNoDot);
        const int point = static_cast<int>(one.point), real = static_cast<int>(truth);
        const Vector2d moved(real % columns - point % columns, real / columns - point / columns);
        if (!shift) shift = moved;
        EXPECT_EQ(moved, *shift);
      }
    }
  }
  EXPECT_GE(pictures, 30);
}

TEST(DotLattice, NothingOutOfBlobsWithoutOrder) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0, 300);
  std::vector<Vector2d> centres;
  for (int i = 0; i < 30; ++i) centres.emplace_back(place(random), place(random));
  EXPECT_LT(camera::number_dots(centres, 9, 7).size(), 12u);
  EXPECT_TRUE(camera::number_dots({}, 9, 7).empty());
  EXPECT_TRUE(camera::number_dots({{1, 1}, {2, 2}}, 9, 7).empty());
}

// More dots in a row than the target has: another target.
TEST(DotLattice, MoreDotsThanTheTargetHasAreRefused) {
  std::vector<Vector2d> centres;
  for (int i = 0; i < 80; ++i) centres.emplace_back(20 + 15 * (i % 10), 20 + 15 * (i / 10));
  EXPECT_TRUE(camera::number_dots(centres, 9, 7).empty());
  EXPECT_EQ(camera::number_dots(centres, 10, 8).size(), 80u);
  // Rows may run down the picture.
  EXPECT_EQ(camera::number_dots(centres, 8, 10).size(), 80u);
}

}  // namespace
}  // namespace impactdic
