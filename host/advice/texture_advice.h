// What a picture's texture lets be measured, before anything is: windows that carry enough of it,
// and the error that its noise leaves at best.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "host/circle/circle.h"
#include "host/clip/roi.h"
#include "host/dic/error_bound.h"

namespace impactdic::advice {

struct SizeAdvice {
  int window_px = 0;
  int windows = 0, usable = 0;
  double error_px = 0;  // median over the usable ones, per axis; NaN where there is none
  double contrast = 0;  // median over all, rms, grey levels of 255
  double usable_share() const { return windows > 0 ? static_cast<double>(usable) / windows : 0; }
};

struct TextureAdvice {
  double noise = 0;                    // standard deviation, grey levels of 255
  SizeAdvice asked;                    // the window size asked for
  std::vector<SizeAdvice> sizes;       // others, ascending
  std::optional<dic::BallBound> ball;  // of the ball as a whole
};

struct TextureRequest {
  int window_px = 15;
  double min_texture = 1;                // as FieldOptions
  double max_sd_px = 0.07;               // the same
  double rim_margin_px = 3;              // windows keep this far inside the ball's rim
  std::optional<circle::Circle> circle;  // the ball; otherwise all of `region`
  Roi region;
};

// Looks at one frame; only at the ball where there is one.
TextureAdvice advise_texture(const Frame& frame, const TextureRequest& request);

// The smallest window by which at least nine in ten are usable and err by at most `error_px`; 0
// where none does.
int window_reaching(const TextureAdvice& advice, double error_px);

}  // namespace impactdic::advice
