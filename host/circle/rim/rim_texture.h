// What a ball's ink looks like along a line, learnt from its inside. Internal to host/circle.
#pragma once

#include <array>

#include "host/circle/rim/rim_lines.h"

namespace impactdic::circle {

// Moments of the ink over kTexture samples from the innermost on, kind by kind.
inline constexpr int kTexture = kInside + 2;
// Kind 0 is bare paint throughout; the others go by the middle and the outer end.
struct RimTexture {
  struct Kind {
    double share;
    double mean[kTexture];
    double covariance[kTexture][kTexture];
  };
  std::array<Kind, kKinds> kinds;
};

// Learns a texture from windows of the ball's inside.
class TextureSums {
 public:
  // kTexture samples from the innermost on, 0 background, 1 bare paint.
  void add(const float* samples, float noise);
  // `paint_sd`: of the level of bare paint from place to place.
  RimTexture result(double paint_sd) const;

 private:
  struct Sums {
    double n = 0;
    double sum[kTexture] = {}, product[kTexture][kTexture] = {};
  };
  double windows_ = 0;
  std::array<Sums, kKinds> kinds_;
};

}  // namespace impactdic::circle
