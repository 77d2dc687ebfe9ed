// What a picture's texture lets be measured, before anything is: windows that carry enough of it,
// and the error that its noise leaves at best.
#pragma once

#include <impactdic/advice.h>

#include <optional>
#include <span>
#include <vector>

#include "host/circle/circle.h"
#include "host/clip/roi.h"
#include "host/dic/error_bound.h"

namespace impactdic::advice {

struct TextureRequest {
  int window_px = 15;
  double min_texture = 1;        // as FieldOptions
  double max_sd_px = 0.07;       // the same
  double rim_margin_px = 3;      // windows keep this far inside the ball's rim
  std::optional<Circle> circle;  // the ball; otherwise all of `region`
  Roi region;
  bool asked_alone = false;  // only windows of `window_px`, neither other sizes nor the whole ball
};

// Looks at one frame; only at the ball where there is one.
TextureAdvice advise_texture(const Frame& frame, const TextureRequest& request);

}  // namespace impactdic::advice
