// When the frames of a run were taken, by the camera's own clock.
#pragma once

#include <impactdic/track.h>

#include <cstdint>
#include <string>
#include <vector>

namespace impactdic::run {

struct FrameClock {
  FrameTimes times;
  double fps = 0, fps_sd = 0;  // of the analysed frames
  // Periods since the first frame, of each; empty where none is missing.
  std::vector<std::int64_t> periods;
  std::vector<std::string> warnings;
};

// `stored_fps`: the rate that the run goes by, 0 where none is known; it counts as exact where the
// file has no times, or where the request gave it. Otherwise it is checked by the line through the
// times: where they agree, their difference and the line's deviation are the rate's; where they do
// not, the times' rate is taken. A camera's clock is even: a time that is off a little is rounded,
// and a gap is a frame that was not stored.
FrameClock read_clock(FrameSource& source, const FrameRange& frames, bool rate_was_given,
                      double stored_fps);

}  // namespace impactdic::run
