#include "host/shake/camera_motion.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "host/base/parallel/parallel_for.h"
#include "host/base/statistics.h"
#include "host/shake/background.h"

namespace impactdic::shake {
namespace {

// Frames that are looked at first: so many spread over the clip, and so many on either side of the
// sharpest turn of the path, where an impact may shake the camera.
constexpr std::size_t kSpread = 32, kBeside = 12;
// Shifts beyond chance: so many frames of those, so far from the median of all, and so many
// deviations.
constexpr std::size_t kFewest = 3;
constexpr double kLeast_px = 0.03, kSds = 6;
// A coder shows the background where it has shown it before, or some hundredths of a pixel on, all
// of it alike: shaken film in H.264 was off by 0.018 (CRF 12) to 0.07 px (28).
constexpr double kCoded_px = 0.05;
// A background that moves by itself is in few frames like that of the reference.
constexpr double kKnownShare = 0.5;

// What can no longer be read shows nothing, and the rows that were measured stay.
bool is_read(FrameSource& source, std::int64_t index, Frame& frame) {
  try {
    source.read(index, frame);
    return true;
  } catch (const Error&) {
    return false;
  }
}

Disc ball_of(const TrackRow& row) {
  if (!row.circle_ok) return {};
  const double oval = std::isfinite(row.e1_px) ? std::hypot(row.e1_px, row.e2_px) : 0;
  return {row.cx_px, row.cy_px, row.r_px + oval};
}

std::optional<std::size_t> sharpest_turn(const TrackRows& rows) {
  std::optional<std::size_t> at;
  double most = 0;
  TrackRow before;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const TrackRow row = rows[i];
    if (before.motion_ok && row.motion_ok) {
      const double change = std::hypot(row.dx_px - before.dx_px, row.dy_px - before.dy_px);
      if (change > most) most = change, at = i;
    }
    before = row;
  }
  return at;
}

std::vector<std::size_t> looked_at_first(const TrackRows& rows) {
  const std::size_t n = rows.size();
  std::vector<std::size_t> places;
  for (std::size_t k = 0; k < kSpread; ++k) places.push_back(k * (n - 1) / (kSpread - 1));
  if (const auto turn = sharpest_turn(rows)) {
    for (std::size_t i = *turn - std::min(*turn, kBeside); i < std::min(n, *turn + kBeside); ++i) {
      places.push_back(i);
    }
  }
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
  return places;
}

// Distances from the median place that chance and a still camera do not explain.
bool is_moving(const std::vector<PictureShift>& shifts) {
  std::vector<double> x, y;
  for (const PictureShift& shift : shifts) {
    if (shift.known) x.push_back(shift.x_px), y.push_back(shift.y_px);
  }
  if (static_cast<double>(x.size()) < kKnownShare * static_cast<double>(shifts.size()))
    return false;
  const double middle_x = median(x), middle_y = median(y);
  const auto beyond = std::count_if(shifts.begin(), shifts.end(), [&](const PictureShift& shift) {
    const double off = std::hypot(shift.x_px - middle_x, shift.y_px - middle_y);
    return shift.known &&
           off > std::max(kLeast_px, kSds * std::hypot(shift.x_sd_px, shift.y_sd_px));
  });
  return static_cast<std::size_t>(beyond) >= kFewest;
}

// A guess for row `i` from the looks before and behind it, of which places[k] is the latter.
PictureShift between(const std::vector<std::size_t>& places,
                     const std::vector<PictureShift>& shifts, std::size_t k, std::size_t i) {
  const PictureShift& behind = shifts[k];
  if (k == 0 || !shifts[k - 1].known) return behind;
  const PictureShift& before = shifts[k - 1];
  if (!behind.known) return before;
  const double part =
      static_cast<double>(i - places[k - 1]) / static_cast<double>(places[k] - places[k - 1]);
  PictureShift guess;
  guess.x_px = before.x_px + part * (behind.x_px - before.x_px);
  guess.y_px = before.y_px + part * (behind.y_px - before.y_px);
  guess.roll_rad = before.roll_rad + part * (behind.roll_rad - before.roll_rad);
  return guess;
}

// The reference lies where it lies; its own noise is like that of the others.
void state_reference(std::size_t row, std::vector<PictureShift>& shifts) {
  std::vector<double> x, y, roll;
  for (std::size_t i = 0; i < shifts.size(); ++i) {
    if (i == row || !shifts[i].known) continue;
    x.push_back(shifts[i].x_sd_px), y.push_back(shifts[i].y_sd_px);
    roll.push_back(shifts[i].roll_sd_rad);
  }
  shifts[row].x_sd_px = upper_median(std::move(x));
  shifts[row].y_sd_px = upper_median(std::move(y));
  shifts[row].roll_sd_rad = upper_median(std::move(roll));
}

void doubt_coded(double width_px, std::vector<PictureShift>& shifts) {
  for (PictureShift& shift : shifts) {
    shift.x_sd_px = std::hypot(shift.x_sd_px, kCoded_px);
    shift.y_sd_px = std::hypot(shift.y_sd_px, kCoded_px);
    shift.roll_sd_rad = std::hypot(shift.roll_sd_rad, kCoded_px / (width_px / 2));
  }
}

class Look {
 public:
  Look(FrameSource& source, const TrackRows& rows, const Background& background,
       const std::function<bool()>& cancelled)
      : source_(source), rows_(rows), background_(background), cancelled_(cancelled) {}

  bool was_cancelled() const { return cancelled_ && cancelled_(); }

  PictureShift operator()(std::size_t i, const PictureShift& guess) const {
    if (was_cancelled()) return {};
    thread_local Frame frame;  // memory only
    const TrackRow row = rows_[i];
    if (!is_read(source_, row.frame, frame)) return {};
    return background_.locate(frame, ball_of(row), guess);
  }

 private:
  FrameSource& source_;
  const TrackRows& rows_;
  const Background& background_;
  const std::function<bool()>& cancelled_;
};

}  // namespace

std::optional<CameraMotion> measure_camera_motion(FrameSource& source, const TrackRows& rows,
                                                  const std::function<bool()>& cancelled) {
  std::size_t first_row = 0;
  while (first_row < rows.size() && !rows[first_row].circle_ok) ++first_row;
  if (first_row == rows.size() || rows.size() < 2 * kFewest) return std::nullopt;
  const TrackRow first = rows[first_row];
  Frame reference;
  if (!is_read(source, first.frame, reference)) return std::nullopt;
  const Background background(reference, ball_of(first));
  if (!background.shows_texture()) return std::nullopt;
  const Look look(source, rows, background, cancelled);
  const std::vector<std::size_t> places = looked_at_first(rows);
  std::vector<PictureShift> some(places.size());
  parallel_for(places.size(), [&](std::size_t k) { some[k] = look(places[k], {}); });
  if (look.was_cancelled() || !is_moving(some)) return std::nullopt;
  CameraMotion motion;
  motion.middle_x_px = 0.5 * (source.info().width - 1);
  motion.middle_y_px = 0.5 * (source.info().height - 1);
  motion.frame_step = std::max<std::int64_t>(1, rows[1].frame - rows[0].frame);
  motion.of_rows.resize(rows.size());
  parallel_for(rows.size(), [&](std::size_t i) {
    const auto next = std::lower_bound(places.begin(), places.end(), i);
    const std::size_t k = std::min<std::size_t>(next - places.begin(), places.size() - 1);
    motion.of_rows[i] = places[k] == i ? some[k] : look(i, between(places, some, k, i));
  });
  if (look.was_cancelled()) return std::nullopt;
  state_reference(first_row, motion.of_rows);
  if (source.info().lossy) doubt_coded(source.info().width, motion.of_rows);
  return motion;
}

MotionExtent extent_of(const CameraMotion& motion) {
  MotionExtent extent;
  PictureShift before;
  for (const PictureShift& shift : motion.of_rows) {
    extent.unknown += !shift.known;
    if (shift.known) {
      extent.farthest_px = std::max(extent.farthest_px, std::hypot(shift.x_px, shift.y_px));
    }
    if (shift.known && before.known) {
      const double step = std::hypot(shift.x_px - before.x_px, shift.y_px - before.y_px);
      extent.largest_step_px = std::max(extent.largest_step_px, step);
    }
    before = shift;
  }
  return extent;
}

std::string in_words(const CameraMotion& motion) {
  const MotionExtent extent = extent_of(motion);
  char text[360];
  std::snprintf(
      text, sizeof text,
      "the background moves, by up to %.2f px and %.2f px from frame to frame, as before a "
      "camera that shakes or pans: velocities, impacts and metres are against it, pixels "
      "are as the picture shows them (--camera-motion ignore: all)",
      extent.farthest_px, extent.largest_step_px);
  std::string words = text;
  if (extent.unknown > 0) {
    words +=
        "; nothing is stated of " + std::to_string(extent.unknown) +
        (extent.unknown == 1 ? " frame where it was not found" : " frames where it was not found");
  }
  return words;
}

}  // namespace impactdic::shake
