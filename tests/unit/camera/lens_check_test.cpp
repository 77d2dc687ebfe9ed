// Flights that bend as through a lens.
#include "host/run/metres/lens/lens_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "tests/support/camera/test_camera.h"
#include "tests/support/camera/through_lens.h"
#include "tests/support/filmed_shot.h"

namespace impactdic::testing {
namespace {

using camera::PlaneView;
using Eigen::Vector2d;

constexpr double kMetrePerPx = 3e-4;

// Flights that a lens bends are told from straight ones.
TEST(LensCheck, FindsOnePercentAndNothingElse) {
  int warned = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    std::mt19937_64 random(seed);
    FilmedShot shot = filmed_shot(random, ScaleBy::kRuler);
    constexpr int kSide = 160;  // so that the flights cross it
    const TrackRow middle = shot.result.rows[static_cast<std::size_t>(shot.truth.start)];
    for (TrackRow& row : shot.result.rows) {
      row.cx_px += kSide / 2.0 - middle.cx_px;
      row.cy_px += kSide / 2.0 - middle.cy_px;
    }
    FilmedShot straight = shot;
    straight.conclude();
    const auto none =
        run::bend_of_flights(straight.result.rows, straight.result.impact, kSide, kSide);
    EXPECT_EQ(run::lens_warning(none, false), "") << seed;
    FilmedShot bent = shot;
    bent.result.rows = through_lens(bent_camera(kSide, shot.filmed.metre_per_px), shot.result.rows,
                                    shot.filmed.metre_per_px);
    bent.conclude();
    const auto bend = run::bend_of_flights(bent.result.rows, bent.result.impact, kSide, kSide);
    ASSERT_TRUE(bend.has_value()) << seed;
    // The distortion is taken for a small one, which costs up to a third where it is large.
    EXPECT_NEAR(bend->corner.value, 0.01, 4 * bend->corner.sd + 0.0035) << seed;
    const std::string warning = run::lens_warning(bend, false);
    warned += !warning.empty();
    if (!warning.empty()) {
      EXPECT_NE(warning.find("impactdic calibrate"), std::string::npos) << warning;
    }
  }
  EXPECT_GE(warned, 5);  // the others fly too short a way
}

// Rows of a ball that moves as `place` says, with the noise of a good ball.
std::vector<TrackRow> rows_along(int frames, const std::function<Vector2d(double)>& place,
                                 unsigned seed = 1, double motion_sd_px = 0.0005) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 1);
  std::vector<TrackRow> rows(static_cast<std::size_t>(frames));
  for (int k = 0; k < frames; ++k) {
    TrackRow& row = rows[static_cast<std::size_t>(k)];
    row.frame = k;
    row.circle_ok = true;
    row.r_px = 45;
    row.cx_sd_px = row.cy_sd_px = 0.005;
    row.dx_sd_px = row.dy_sd_px = motion_sd_px;
    const Vector2d at = place(k), to = place(k + 1.0);
    row.cx_px = at.x() + 0.005 * noise(random), row.cy_px = at.y() + 0.005 * noise(random);
    row.motion_ok = true;
    row.dx_px = to.x() - at.x() + motion_sd_px * noise(random);
    row.dy_px = to.y() - at.y() + motion_sd_px * noise(random);
    row.rot_deg = 0;
  }
  return rows;
}

// A ball on a string or a wheel tells nothing of the lens.
TEST(LensCheck, PathsThatAreNoFlightTellNothing) {
  const auto warning = [](int frames, double radius, double rate, const Vector2d& middle) {
    const auto rows = rows_along(frames, [&](double t) -> Vector2d {
      return middle + radius * Vector2d(std::cos(rate * t), std::sin(rate * t));
    });
    // As if it had been taken for a flight, and as a clip in which none was found.
    ImpactAnalysis flight;
    flight.flight.last = rows.size() - 2;
    return run::lens_warning(run::bend_of_flights(rows, flight, 512, 512), false) +
           run::lens_warning(run::bend_of_flights(rows, {}, 512, 512), false);
  };
  for (const double radius : {30.0, 60.0, 110.0, 200.0}) {
    for (const double rate : {0.002, 0.01, 0.03, 0.1, 0.3}) {
      for (const Vector2d& middle : {Vector2d(255.5, 255.5), Vector2d(240, 270)}) {
        for (const int frames : {20, 60, 200}) {
          EXPECT_EQ(warning(frames, radius, rate, middle), "")
              << radius << " px, " << rate << " rad, " << frames << " frames";
        }
      }
    }
  }
}

// A steep throw turns by far more than a lens bends it, but falls as it must.
TEST(LensCheck, AThrowThatFallsAsItMustTellsOfTheLens) {
  const Camera camera = bent_camera(512, kMetrePerPx, 0.01);
  const PlaneView plane(camera);
  const auto rows = rows_along(70, [&](double t) -> Vector2d {
    const Vector2d straight(60 + 5.5 * t, 420 - 9.0 * t + 0.065 * t * t);
    return plane.to_picture({straight.x() * kMetrePerPx, (511 - straight.y()) * kMetrePerPx, 0});
  });
  ImpactAnalysis flight;
  flight.flight.last = rows.size() - 2;
  EXPECT_EQ(run::lens_warning(run::bend_of_flights(rows, flight, 512, 512), false), "");
  const auto bend = run::bend_of_flights(rows, flight, 512, 512, run::FallInPicture{0, 0.13});
  ASSERT_TRUE(bend);
  EXPECT_NEAR(bend->corner.value, 0.01, 0.0035);
  EXPECT_NE(run::lens_warning(bend, false), "");
}

// A small ball that flies about in a corner of a large picture: its motions are noisy, and a lens
// bends by a share of them.
TEST(LensCheck, NoiseIsNoLens) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const auto rows = rows_along(
        500,
        [](double t) -> Vector2d {
          return {60 + 0.27 * t, 45 + 0.3 * t + 2.5e-4 * t * t};
        },
        seed, 0.005);
    EXPECT_EQ(run::lens_warning(run::bend_of_flights(rows, {}, 1280, 800), false), "") << seed;
  }
}

}  // namespace
}  // namespace impactdic::testing
