// Which frames of a batch are left out because they show the picture before them once more.
#include "host/pipeline/rows/repeated_frames.h"

#include <gtest/gtest.h>

namespace impactdic::pipeline {
namespace {

constexpr std::size_t kRepeat = 5;

// Twelve rows of a ball that goes `step_px` a frame, each step known to `sd_px`; the picture of one
// is that of the frame before.
TrackBatch batch_of(double step_px, double sd_px) {
  TrackBatch batch;
  for (std::size_t i = 0; i < 12; ++i) {
    TrackRow row;
    row.frame = static_cast<std::int64_t>(i);
    row.status = TrackStatus::kOk;
    row.circle_ok = row.motion_ok = true;
    row.r_px = 50;
    row.dx_px = i + 1 == kRepeat ? 0 : i == kRepeat ? 2 * step_px : step_px;
    row.dy_px = row.rot_deg = row.rot_sd_deg = 0;
    row.dx_sd_px = row.dy_sd_px = sd_px;
    batch.rows.push_back(row);
  }
  batch.repeats.assign(batch.rows.size(), false);
  batch.repeats[kRepeat] = true;
  batch.measured.assign(batch.rows.size() - 1, true);
  return batch;
}

bool leaves_out(TrackBatch batch) {
  leave_out_repeats(batch, nullptr, false);
  return batch.rows[kRepeat].status == TrackStatus::kRepeated;
}

TEST(RepeatedFrames, OfABallThatMoves) { EXPECT_TRUE(leaves_out(batch_of(0.5, 0.002))); }

// A turn out of the plane that nobody sees may make a tenth of every step of a ball with few marks.
TEST(RepeatedFrames, OfOneWhoseStepsMayAllBeOffAlike) {
  EXPECT_TRUE(leaves_out(batch_of(0.5, 0.05)));
}

TEST(RepeatedFrames, NoneOfABallThatRests) {
  EXPECT_FALSE(leaves_out(batch_of(0.05, 0.002)));
  EXPECT_FALSE(leaves_out(batch_of(0.5, 0.3)));
}

}  // namespace
}  // namespace impactdic::pipeline
