#include "host/run/metres/lost_frames.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/base/statistics.h"
#include "host/clip/surface_step.h"

namespace impactdic::run {
namespace {

// Half of the steps that are compared with one.
constexpr std::size_t kBeside = 2;
// A ball that moves by less shows no gap.
constexpr double kLeast_px = 0.2;
// How far steps may lie from the mean of those beside, or from a multiple of it: of that mean. They
// must be known so well that so many deviations are no more, of what they state or, since that may
// be alike in all of them, of what those beside scatter by.
constexpr double kEven = 0.1, kSds = 5;
constexpr double kMostMissing = 9;

bool is_whole(const TrackRow& row) {
  return row.status == TrackStatus::kOk && row.motion_ok && row.circle_ok && row.periods == 1;
}

// How many frames are missing behind the middle one of some rows; 0 where that cannot be said.
int missing_behind(const std::array<TrackRow, 2 * kBeside + 1>& rows) {
  SurfaceStep mean;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!is_whole(rows[i])) return 0;
    if (i != kBeside) mean.add(SurfaceStep(rows[i]), 1.0 / (2 * kBeside));
  }
  const double usual = mean.length();
  if (!(usual > kLeast_px)) return 0;
  const auto off = [&](const TrackRow& row, double times) {
    SurfaceStep rest(row);
    rest.add(mean, -times);
    return rest.length();
  };
  double scatter = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i != kBeside) scatter = std::max(scatter, off(rows[i], 1));
  }
  const TrackRow& row = rows[kBeside];
  const double times = std::round(SurfaceStep(row).length() / usual);
  if (times < 2 || times > 1 + kMostMissing) return 0;
  const bool known = kSds * std::min(SurfaceStep::sd_px(row), scatter) < kEven * usual;
  if (!known || !(std::max(scatter, off(row, times)) < kEven * usual)) return 0;
  return static_cast<int>(times) - 1;
}

}  // namespace

std::string repeats_warning(const TrackRows& rows) {
  std::int64_t count = 0, first = 0;
  std::vector<double> steps;  // behind a repeated frame, in those before it
  TrackRow before, last;
  for (const TrackRow& row : rows) {
    if (row.status == TrackStatus::kRepeated && !row.circle_ok && count++ == 0) first = row.frame;
    if (!row.circle_ok) continue;
    const double way_px = std::hypot(row.cx_px - last.cx_px, row.cy_px - last.cy_px);
    if (last.status == TrackStatus::kRepeated && row.frame > last.frame + 1) {
      steps.push_back(way_px / std::hypot(before.dx_px, before.dy_px));
    }
    if (row.motion_ok) before = row;
    last = row;
  }
  if (count == 0) return "";
  std::string text =
      std::to_string(count) +
      (count == 1
           ? " frame shows the picture before it, or a part of it, once more, frame "
           : " frames show the picture before them, or a part of it, once more, the first is "
             "frame ") +
      std::to_string(first) + ": left out";
  constexpr double kHalfWay = 1.5;  // between none of the time and all of it
  if (!steps.empty() && median(steps) < kHalfWay) {
    text +=
        "; the ball has not gone on meanwhile, so that they were put in and times behind them "
        "are too late: give the film as it was taken";
  }
  return text;
}

std::vector<MissingFrames> missing_frames(const TrackRows& rows) {
  std::vector<MissingFrames> missing;
  std::array<TrackRow, 2 * kBeside + 1> beside;
  std::size_t seen = 0;
  for (const TrackRow& row : rows) {
    std::move(beside.begin() + 1, beside.end(), beside.begin());
    beside.back() = row;
    if (++seen < beside.size()) continue;
    const int here = missing_behind(beside);
    if (here > 0) missing.push_back({seen - 1 - kBeside, here});
  }
  return missing;
}

void count(const std::vector<MissingFrames>& missing, double fps, std::size_t i, TrackRow& row) {
  int before = 0;
  for (const MissingFrames& gap : missing) {
    if (gap.behind > i) break;
    if (gap.behind == i) {
      row.periods += gap.count;
    } else {
      before += gap.count;
    }
  }
  // In whole periods: a sum of two times would differ from the clock's in its last digit.
  if (before > 0) row.time_s = (std::round(row.time_s * fps) + before) / fps;
}

std::string missing_warning(const std::vector<MissingFrames>& missing, const TrackRows& rows) {
  int frames = 0;
  for (const MissingFrames& gap : missing) frames += gap.count;
  return "the ball goes a whole number of times as far as in the steps beside at " +
         std::to_string(missing.size()) +
         (missing.size() == 1 ? " place, behind frame " : " places, the first behind frame ") +
         std::to_string(rows[missing.front().behind].frame) + ": " + std::to_string(frames) +
         (frames == 1 ? " frame is" : " frames are") +
         " missing there, of which the file tells no times; times and velocities of the track "
         "count them, frame numbers do not";
}

}  // namespace impactdic::run
