// Whether the search for an impact tells one from none (bench/impact_evidence has the long form).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/tracks/path_tracks.h"

namespace impactdic::testing {
namespace {

bool is_found(const ImpactAnalysis& analysis) {
  return analysis.status == ImpactStatus::kFound || analysis.status == ImpactStatus::kNotResolved;
}

// Circles, throws, rolling, pendulums, hands, balls that are let go, straight lines.
TEST(ImpactEvidence, NoSmoothPathIsAnImpact) {
  constexpr std::uint64_t kEach = 12;
  for (const FreePath kind : kFreePaths) {
    for (std::uint64_t seed = 1; seed <= kEach; ++seed) {
      const FreeTrack track = free_track(kind, seed);
      EXPECT_EQ(impact::analyse_impact(track.rows, track.options).status, ImpactStatus::kNone)
          << name_of(kind) << ' ' << seed;
    }
  }
}

// Contacts of one to a hundred frames, in tracks as good as a camera's and as poor as a coder's.
TEST(ImpactEvidence, ImpactsAreFoundInPoorFilm) {
  constexpr std::uint64_t kShots = 100;
  constexpr int kMissed = 3, kOff = 7;  // 2 % and 3 % of 500, by chance up to these
  int missed = 0, off = 0;
  for (std::uint64_t seed = 1; seed <= kShots; ++seed) {
    const ImpactTrack track = impact_track(seed);
    const ImpactAnalysis found = impact::analyse_impact(track.rows, track.options);
    missed += !is_found(found);
    const Measured& e = found.restitution;
    if (is_found(found)) off += !(std::abs(e.value - track.truth.restitution) < 3 * e.sd);
    EXPECT_FALSE(is_found(found) && !(e.sd < 0.5)) << seed;
    // A start or an end that could not be found is not stated.
    for (const Measured& edge : {found.start.instant, found.end.instant}) {
      EXPECT_FALSE(std::isfinite(edge.value) && !(edge.sd < found.duration.value)) << seed;
    }
  }
  EXPECT_LE(missed, kMissed);
  EXPECT_LE(off, kOff);
}

// A contact of some frames is never mistaken for a smooth path, however the coder shifts pictures.
TEST(ImpactEvidence, ShortContactsAreFound) {
  int shorts = 0, found = 0;
  for (std::uint64_t seed = 200; shorts < 40; ++seed) {
    const ImpactTrack track = impact_track(seed);
    if (track.truth.end - track.truth.start > 10) continue;
    ++shorts;
    found += is_found(impact::analyse_impact(track.rows, track.options));
  }
  EXPECT_EQ(found, shorts);
}

// A ball that is dropped and bounces, each time with four fifths of its speed.
struct Bouncing {
  static constexpr double kGravity = 0.02, kFirst = 90, kRestitution = 0.8;  // px, frames
  std::vector<double> touches;

  explicit Bouncing(int frames) {
    double touch = kFirst + 0.3, speed = kGravity * touch;
    while (touch < frames) {
      touches.push_back(touch);
      speed *= kRestitution;
      touch += 2 * speed / kGravity;
    }
  }
  std::array<double, 2> at(double t) const {
    double speed = kGravity * touches[0], from = touches[0];
    if (t < from) return {0.4 * t, kGravity * (from * from - t * t) / 2};
    for (const double touch : touches) {
      if (touch > t) break;
      from = touch, speed *= kRestitution;
    }
    return {0.4 * t, speed * (t - from) - kGravity * (t - from) * (t - from) / 2};
  }
};

TEST(ImpactEvidence, EveryBounceIsFound) {
  constexpr int kFrames = 480;
  const Bouncing ball(kFrames);
  ASSERT_EQ(ball.touches.size(), 4u);
  for (const bool poor : {false, true}) {
    std::mt19937_64 random(7);
    std::vector<TrackRow> rows = rows_of([&](double t) { return ball.at(t); }, kFrames, 0.02);
    add_errors(poor ? FilmErrors::coder(1) : FilmErrors::camera(1), random, rows);
    impact::ImpactOptions options;
    options.gravity = Bouncing::kGravity;
    const ImpactAnalysis sharpest = impact::analyse_impact(rows, options);
    ASSERT_TRUE(is_found(sharpest)) << poor;
    std::vector<ImpactAnalysis> all = impact::other_impacts(rows, options, sharpest);
    all.push_back(sharpest);
    std::sort(all.begin(), all.end(), [](const ImpactAnalysis& a, const ImpactAnalysis& b) {
      return a.crossing.value < b.crossing.value;
    });
    ASSERT_EQ(all.size(), ball.touches.size()) << poor;
    for (std::size_t i = 0; i < all.size(); ++i) {
      EXPECT_NEAR(all[i].crossing.value, ball.touches[i], 1) << poor << ' ' << i;
      EXPECT_NEAR(all[i].turn.value, ball.touches[i], 1 + 3 * all[i].turn.sd) << poor << ' ' << i;
      const Measured& e = all[i].restitution;
      EXPECT_LT(std::abs(e.value - Bouncing::kRestitution), 4 * e.sd) << poor << ' ' << i;
      EXPECT_LT(e.sd, 0.1) << poor << ' ' << i;
    }
  }
}

// Nothing more is found where there is but one.
TEST(ImpactEvidence, OneImpactIsOne) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const ImpactTrack track = impact_track(seed);
    const ImpactAnalysis found = impact::analyse_impact(track.rows, track.options);
    EXPECT_TRUE(impact::other_impacts(track.rows, track.options, found).empty()) << seed;
  }
}

}  // namespace
}  // namespace impactdic::testing
