// What `fit` reads of a track.csv.
#include "sim/shot/track_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "tests/support/scratch.h"
#include "tests/support/synthetic_track.h"

namespace impactdic::testing {
namespace {

// As `track` does: what the circles contradict is no motion.
TEST(TrackTable, LeavesOutMotionsThatTheCirclesContradict) {
  const ScratchFolder folder;
  ImpactJob job;
  job.body = {BodyShape::kHollowSphere, 0.0567, 0.067};
  job.contact.stiffness = 12526;
  job.initial.vn_m_s = -2.8;
  job.initial.vt_m_s = -1.6;
  SyntheticTrack track{job};
  track.motion = true;
  write_track(track, folder / "track.csv");
  std::string text = read_text(folder / "track.csv");
  const std::size_t row = text.find("\n5,");
  ASSERT_NE(row, std::string::npos);
  const std::size_t ok = text.find(",ok,", row);
  text.replace(ok, 4, ",inconsistent,");
  std::ofstream(folder / "track.csv") << text;
  const auto read = sim::shot::read_track(folder / "track.csv");
  for (const std::size_t i : {4U, 5U, 6U}) {
    EXPECT_EQ(std::isnan(read.dx_m[i]), i == 5) << i;
    EXPECT_EQ(std::isnan(read.turn_rad[i]), i == 5) << i;
    EXPECT_FALSE(std::isnan(read.x_m[i])) << i;
  }
}

}  // namespace
}  // namespace impactdic::testing
