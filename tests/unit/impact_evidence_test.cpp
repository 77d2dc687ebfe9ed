// Whether the search for an impact tells one from none (bench/impact_evidence has the long form).
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace impactdic::testing
