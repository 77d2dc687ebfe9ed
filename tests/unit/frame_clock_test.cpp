// The rate of the frames and the missing ones by a camera's own times.
#include "host/run/metres/frame_clock.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

#include "host/clip/row_store.h"
#include "tests/support/filmed_shot.h"
#include "tests/support/scratch.h"

namespace impactdic::testing {
namespace {

class TimedClip : public FrameSource {
 public:
  explicit TimedClip(std::vector<double> times) : times_(std::move(times)) {
    info_.frame_count = static_cast<std::int64_t>(times_.size());
    info_.has_timestamps = true;
  }
  const ClipInfo& info() const override { return info_; }
  void read(std::int64_t, Frame&) override {}
  std::optional<double> frame_time_s(std::int64_t index) override {
    return times_[static_cast<std::size_t>(index)];
  }

 private:
  std::vector<double> times_;
  ClipInfo info_;
};

std::uint64_t bits_of(double value) { return std::bit_cast<std::uint64_t>(value); }

// `interval_s` apart, rounded to `tick_s`, without the frames in `lost`.
TimedClip clip_of(int count, double interval_s, double tick_s, const std::vector<int>& lost = {}) {
  std::vector<double> times;
  for (int i = 0; i < count; ++i) {
    if (std::find(lost.begin(), lost.end(), i) != lost.end()) continue;
    times.push_back(std::round(i * interval_s / tick_s) * tick_s);
  }
  return TimedClip(times);
}

run::FrameClock clock_of(TimedClip clip, double stored_fps, bool given = false) {
  return run::read_clock(clip, {0, clip.info().frame_count, 1}, given, stored_fps);
}

TEST(FrameClock, RoundedTimesConfirmTheRate) {
  const run::FrameClock clock = clock_of(clip_of(400, 1.0 / 30000, 1e-6), 30000);
  EXPECT_EQ(clock.fps, 30000);
  EXPECT_TRUE(clock.periods.empty());
  EXPECT_TRUE(clock.warnings.empty());
  EXPECT_TRUE(clock.times.measured);
  EXPECT_NEAR(clock.times.jitter_s, 1e-6 / std::sqrt(12.0), 0.3e-6);
  EXPECT_GT(clock.fps_sd, 0);
  EXPECT_LT(clock.fps_sd, 30000 * 1e-4);
}

TEST(FrameClock, TimesOverrideAHeaderThatIsWrong) {
  const run::FrameClock clock = clock_of(clip_of(200, 1.0 / 9950, 1e-9), 10000);
  EXPECT_NEAR(clock.fps, 9950, 0.1);
  ASSERT_EQ(clock.warnings.size(), 1u);
  EXPECT_NE(clock.warnings[0].find("9950"), std::string::npos) << clock.warnings[0];
  // The rate that a person gives counts.
  EXPECT_EQ(clock_of(clip_of(200, 1.0 / 9950, 1e-9), 10000, true).fps, 10000);
}

TEST(FrameClock, MissingFramesAreCounted) {
  const run::FrameClock clock = clock_of(clip_of(100, 1e-4, 1e-6, {40, 41, 70}), 10000);
  EXPECT_EQ(clock.times.missing, 3);
  EXPECT_EQ(clock.times.missing_after, 39);
  ASSERT_EQ(clock.periods.size(), 97u);
  EXPECT_EQ(clock.periods[39], 39);
  EXPECT_EQ(clock.periods[40], 42);
  EXPECT_EQ(clock.periods.back(), 99);
  EXPECT_EQ(clock.fps, 10000);
  ASSERT_EQ(clock.warnings.size(), 1u);
}

TEST(FrameClock, NoTimesNoRate) {
  TimedClip clip = clip_of(5, 1e-4, 1e-9);  // too few to tell
  EXPECT_EQ(clock_of(clip, 0).fps, 0);
  EXPECT_FALSE(clock_of(clip, 0).times.measured);
}

TEST(FrameClock, EveryStepsFrameCounts) {
  TimedClip clip = clip_of(300, 1e-4, 1e-9);
  const run::FrameClock clock = run::read_clock(clip, {10, 300, 3}, false, 10000);
  EXPECT_NEAR(clock.fps, 10000 / 3.0, 1e-6);
  EXPECT_TRUE(clock.periods.empty());
}

// A ball that rests before it falls: most of the rows are in the file.
TEST(FrameClock, RowsInAFileLeadToTheSameFigures) {
  std::mt19937_64 random(5);
  FilmedShot shot = filmed_shot(random, ScaleBy::kDiameter);
  std::vector<TrackRow>& rows = shot.result.rows;
  TrackRow still = rows.front();
  still.motion_ok = still.circle_ok = false;
  still.status = TrackStatus::kNoBall;
  rows.insert(rows.begin(), 1500, still);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].frame = static_cast<std::int64_t>(i);
  const ScratchFolder folder;
  RowStore store(folder.string(), 0);
  for (const TrackRow& row : rows) store.push_back(row);
  shot.conclude();
  TrackResult other;
  other.scale = shot.result.scale;
  other.scale.metre_per_px = 0;
  run::conclude_metres(shot.request, std::nullopt, store, other);
  ASSERT_EQ(shot.result.impact_si.status, ImpactStatus::kFound);
  std::vector<double> found;
  each_figure(shot, [&](const char*, const Measured& m, double) {
    found.push_back(m.value);
    found.push_back(m.sd);
  });
  FilmedShot by_file = shot;
  by_file.result = other;
  std::size_t at = 0;
  each_figure(by_file, [&](const char* name, const Measured& m, double) {
    EXPECT_EQ(bits_of(m.value), bits_of(found[at++])) << name;
    EXPECT_EQ(bits_of(m.sd), bits_of(found[at++])) << name;
  });
  EXPECT_EQ(bits_of(other.scale.metre_per_px), bits_of(shot.result.scale.metre_per_px));
}

// Frames that are missing in flight and in contact change no figure beyond its deviation.
TEST(FrameClock, AnImpactWithMissingFramesIsTheSame) {
  std::mt19937_64 random(8);
  FilmedShot shot = filmed_shot(random, ScaleBy::kRuler);
  std::vector<TrackRow>& rows = shot.result.rows;
  const auto touch = static_cast<std::size_t>(shot.truth.start);
  for (const std::size_t lost : {touch + 20, touch - 15, touch - 16}) {
    TrackRow& before = rows[lost - 1];
    before.dx_px += rows[lost].dx_px, before.dy_px += rows[lost].dy_px;
    before.periods += rows[lost].periods;
    rows.erase(rows.begin() + static_cast<std::ptrdiff_t>(lost));
  }
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].frame = static_cast<std::int64_t>(i);
  shot.conclude();
  const ImpactFigures& found = shot.result.impact_si;
  ASSERT_EQ(found.status, ImpactStatus::kFound);
  EXPECT_TRUE(found.contradictions.empty());
  const auto expect = [](const Measured& m, double truth) {
    EXPECT_NEAR(m.value, truth, 3 * m.sd);
  };
  expect(found.before.vn, shot.truth.before.vn_m_s);
  expect(found.after.vn, shot.truth.after.vn_m_s);
  expect(found.restitution, shot.truth.restitution);
  EXPECT_NEAR(found.t0.time_s, shot.truth.start / shot.filmed.fps, 3 * found.t0.sd_s);
  // Two stored frames fewer before it.
  EXPECT_NEAR(found.t0.frame, shot.truth.start - 2, 3 * found.t0.sd_frames);
}

}  // namespace
}  // namespace impactdic::testing
