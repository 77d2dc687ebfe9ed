#include "host/run/metres/lost_frames.h"

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
// must be known so well that so many deviations are no more.
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
  const auto is_near = [&](const TrackRow& row, double times) {
    SurfaceStep off(row);
    off.add(mean, -times);
    return kSds * SurfaceStep::sd_px(row) < kEven * usual && off.length() < kEven * usual;
  };
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i != kBeside && !is_near(rows[i], 1)) return 0;
  }
  const double times = std::round(SurfaceStep(rows[kBeside]).length() / usual);
  if (times < 2 || times > 1 + kMostMissing || !is_near(rows[kBeside], times)) return 0;
  return static_cast<int>(times) - 1;
}

std::string of_repeats(const TrackRows& rows) {
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

std::string of_gaps(const TrackRows& rows) {
  std::int64_t gaps = 0, missing = 0, first = 0;
  std::array<TrackRow, 2 * kBeside + 1> beside;
  std::size_t seen = 0;
  for (const TrackRow& row : rows) {
    std::move(beside.begin() + 1, beside.end(), beside.begin());
    beside.back() = row;
    if (++seen < beside.size()) continue;
    const int here = missing_behind(beside);
    if (here > 0 && gaps++ == 0) first = beside[kBeside].frame;
    missing += here;
  }
  if (gaps == 0) return "";
  return "the ball goes a whole number of times as far as in the steps beside at " +
         std::to_string(gaps) +
         (gaps == 1 ? " place, behind frame " : " places, the first behind frame ") +
         std::to_string(first) + ": " + std::to_string(missing) +
         (missing == 1 ? " frame is" : " frames are") +
         " missing there, the file tells no times, and all that is measured over time is wrong "
         "about them: analyse the frames on one side (--frames)";
}

}  // namespace

std::vector<std::string> frame_warnings(const TrackRows& rows) {
  std::vector<std::string> warnings;
  for (std::string (*say)(const TrackRows&) : {of_repeats, of_gaps}) {
    if (std::string text = say(rows); !text.empty()) warnings.push_back(std::move(text));
  }
  return warnings;
}

}  // namespace impactdic::run
