// Rows that are not all in memory are those that were put in.
#include "host/clip/track_rows.h"

#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <bit>
#include <cmath>
#include <future>

#include "host/clip/row_store.h"
#include "tests/support/scratch.h"

namespace impactdic::testing {
namespace {

// Every row another one, with what was not measured.
TrackRow numbered_row(std::int64_t i) {
  TrackRow row;
  row.frame = i;
  row.time_s = static_cast<double>(i) / 3;
  row.status = static_cast<TrackStatus>(i % 7);
  row.circle_ok = i % 3 != 0;
  row.cx_px = std::sin(static_cast<double>(i));
  row.rot_deg = i % 2 == 0 ? kNotMeasured : -1.0 / static_cast<double>(i);
  row.windows = static_cast<int>(i % 100);
  row.pose.keyframe = i / 10;
  return row;
}

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

void expect_numbered(const TrackRows& rows, std::int64_t first = 0) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const TrackRow row = rows[i], put = numbered_row(first + static_cast<std::int64_t>(i));
    ASSERT_EQ(row.frame, put.frame);
    ASSERT_EQ(bits(row.time_s), bits(put.time_s));
    ASSERT_EQ(row.status, put.status);
    ASSERT_EQ(row.circle_ok, put.circle_ok);
    ASSERT_EQ(bits(row.cx_px), bits(put.cx_px));
    ASSERT_EQ(bits(row.rot_deg), bits(put.rot_deg));
    ASSERT_EQ(row.windows, put.windows);
    ASSERT_EQ(row.pose.keyframe, put.pose.keyframe);
  }
}

TEST(RowStore, GivesBackWhatWasPutIn) {
  const ScratchFolder folder;
  for (const std::size_t in_memory : {std::size_t{0}, std::size_t{2000}, RowStore::kInMemory}) {
    RowStore store(folder.string(), in_memory);
    for (std::int64_t i = 0; i < 5000; ++i) {
      store.push_back(numbered_row(i));
      if (i % 977 == 0) expect_numbered(store);  // also while it grows
    }
    ASSERT_EQ(store.size(), 5000u);
    expect_numbered(store);
    expect_numbered(TrackRows(store).part(1500, 3100), 1500);
    EXPECT_EQ(TrackRows(store).part(100, 4000).find_frame(2600), 2500u);
    EXPECT_FALSE(TrackRows(store).find_frame(5000));
  }
  // The file has no name.
  EXPECT_TRUE(std::filesystem::is_empty(folder.string()));
}

TEST(RowStore, SeveralThreadsReadAtOnce) {
  const ScratchFolder folder;
  RowStore store(folder.string(), 0);
  for (std::int64_t i = 0; i < 4000; ++i) store.push_back(numbered_row(i));
  std::vector<std::future<bool>> readers;
  for (std::size_t step : {1u, 7u, 611u, 1999u}) {
    readers.push_back(std::async(std::launch::async, [&store, step] {
      bool same = true;
      for (std::size_t k = 0, i = 0; k < 4000; ++k, i = (i + step) % 4000) {
        same = same && store.row(i).frame == static_cast<std::int64_t>(i);
      }
      return same;
    }));
  }
  for (auto& reader : readers) EXPECT_TRUE(reader.get());
}

// What was measured is not lost where the disk refuses it.
TEST(RowStore, SaysWhatTheDiskRefusesAndKeepsTheRows) {
  const ScratchFolder folder;
  RowStore store(folder.file("is_not_there"), 1000);
  std::int64_t refused = 0;
  for (std::int64_t i = 0; i < 1200; ++i) {
    try {
      store.push_back(numbered_row(i));
    } catch (const FileError& error) {
      EXPECT_NE(error.line().find("is_not_there"), std::string::npos);
      ++refused;
    }
  }
  EXPECT_EQ(refused, 200);
  ASSERT_EQ(store.size(), 1200u);
  expect_numbered(store);
}

TEST(EvenRows, HoldAnEmptyRowForEachMissingFrame) {
  std::vector<TrackRow> rows;
  for (std::int64_t i = 0; i < 6; ++i) rows.push_back(numbered_row(i));
  for (TrackRow& row : rows) row.motion_ok = true, row.dx_px = 1;
  rows[0].periods = 2;
  rows[3].periods = 4;
  rows[4].periods = 2;  // right behind a gap
  rows[5].periods = 9;  // to a frame that was not measured
  const EvenRows even(rows);
  ASSERT_EQ(even.size(), 6u + 1 + 3 + 1);
  const std::int64_t frames[] = {0, 0, 1, 2, 3, 3, 3, 3, 4, 4, 5};
  const bool missing[] = {false, true, false, false, false, true, true, true, false, true, false};
  for (std::size_t i = 0; i < even.size(); ++i) {
    const TrackRow row = even.row(i);
    EXPECT_EQ(row.frame, frames[i]) << i;
    EXPECT_EQ(std::isnan(row.cx_px), missing[i]) << i;
    const bool over_gap = i == 0 || i == 4 || i == 8;
    EXPECT_EQ(row.motion_ok, !missing[i] && !over_gap) << i;
    EXPECT_EQ(std::isfinite(row.dx_px), row.motion_ok) << i;
  }
  const EvenRows changed(rows, [](TrackRow& row) { row.cx_px += 10; });
  EXPECT_EQ(changed.row(3).cx_px, rows[2].cx_px + 10);
}

}  // namespace
}  // namespace impactdic::testing
