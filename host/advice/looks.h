// The frames of a clip that are looked at before it is measured. Internal to host/advice.
#pragma once

#include <optional>
#include <vector>

#include "host/advice/clip_advice.h"
#include "host/advice/frames/noise_memory.h"

namespace impactdic::advice {

// Two neighbouring frames and the ball in them.
struct Look {
  std::int64_t index = 0;
  bool read = false;
  Frame first, second;  // cropped
  std::optional<FoundBall> first_ball, second_ball;
  double saturated = 0;
  std::optional<double> edge_px, turn_deg, shift_px;
  bool interlaced = false, repeats_pixels = false;
  std::optional<NoiseMemory> memory;
};

// The start, the middle and the end of the range, as advise_clip says; where none of these shows
// the ball twice, some of request.spare_sightings too.
std::vector<Look> look_around(FrameSource& source, const AdviceRequest& request);

}  // namespace impactdic::advice
