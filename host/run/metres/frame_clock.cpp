#include "host/run/metres/frame_clock.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host/base/parse.h"
#include "host/base/statistics.h"

namespace impactdic::run {
namespace {

constexpr std::int64_t kFewestTimes = 8;
constexpr double kAgreement = 1e-4;   // of two rates
constexpr double kMuchJitter = 0.05;  // of an interval

// Of the frames, in seconds; none where one is missing or does not grow.
std::vector<double> times_of(FrameSource& source, const FrameRange& frames) {
  std::vector<double> times;
  if (!source.info().has_timestamps || frames.count() < kFewestTimes) return times;
  for (std::int64_t i = 0; i < frames.count(); ++i) {
    const std::optional<double> time = source.frame_time_s(frames.at(i));
    if (!time || (!times.empty() && !(*time > times.back()))) return {};
    times.push_back(*time);
  }
  return times;
}

double usual_interval(const std::vector<double>& times) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < times.size(); ++i) intervals.push_back(times[i] - times[i - 1]);
  return upper_median(std::move(intervals));
}

struct Line {
  double slope = 0, slope_sd = 0, scatter = 0;
};

Line line_through(const std::vector<std::int64_t>& x, const std::vector<double>& y) {
  const auto count = static_cast<double>(x.size());
  double mean_x = 0, mean_y = 0, xx = 0, xy = 0, squares = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_x += static_cast<double>(x[i]) / count, mean_y += y[i] / count;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double off = static_cast<double>(x[i]) - mean_x;
    xx += off * off, xy += off * (y[i] - mean_y);
  }
  Line line;
  line.slope = xy / xx;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double off = y[i] - mean_y - line.slope * (static_cast<double>(x[i]) - mean_x);
    squares += off * off;
  }
  line.scatter = std::sqrt(squares / (count - 2));
  line.slope_sd = line.scatter / std::sqrt(xx);
  return line;
}

std::string in_seconds(double s) {
  char text[40];
  std::snprintf(text, sizeof text, "%.3g us", 1e6 * s);
  return text;
}

// Sets the rate by that of the times.
void compare(const Line& line, FrameClock& clock) {
  const double by_times = 1 / line.slope, sd = line.slope_sd / line.slope;
  const double off = std::abs(clock.fps * line.slope - 1);
  if (clock.fps > 0 && off <= 3 * sd + kAgreement) {
    clock.fps_sd = clock.fps * std::max(sd, off);
    return;
  }
  if (clock.fps > 0) {
    clock.warnings.push_back("the frame times say " + shortest(by_times) +
                             " analysed frames/s, the header " + shortest(clock.fps) +
                             ": the times are taken (--fps overrides them)");
  }
  clock.fps = by_times;
  clock.fps_sd = by_times * sd;
}

}  // namespace

FrameClock read_clock(FrameSource& source, const FrameRange& frames, bool rate_was_given,
                      double stored_fps) {
  FrameClock clock;
  clock.fps = stored_fps / static_cast<double>(frames.step);
  const std::vector<double> times = times_of(source, frames);
  if (times.empty()) return clock;
  const double interval = usual_interval(times);
  clock.periods.push_back(0);
  for (std::size_t i = 1; i < times.size(); ++i) {
    const auto gap = std::max<std::int64_t>(1, std::llround((times[i] - times[i - 1]) / interval));
    if (gap > 1 && clock.times.missing == 0) clock.times.missing_after = frames.at(i - 1);
    clock.times.missing += gap - 1;
    clock.periods.push_back(clock.periods.back() + gap);
  }
  const Line line = line_through(clock.periods, times);
  clock.times.measured = !rate_was_given;
  clock.times.jitter_s = line.scatter;
  if (!rate_was_given) compare(line, clock);
  if (clock.times.missing > 0) {
    clock.warnings.push_back(
        "by its frame times the camera left out " + std::to_string(clock.times.missing) +
        " frames, the first after frame " + std::to_string(clock.times.missing_after) +
        ": the motion over a gap is a mean over it");
  } else {
    clock.periods.clear();
  }
  if (line.scatter > kMuchJitter * interval) {
    clock.warnings.push_back("the frame times scatter by " + in_seconds(line.scatter) + " about " +
                             in_seconds(interval) + " a frame: were the frames taken evenly?");
  }
  return clock;
}

}  // namespace impactdic::run
