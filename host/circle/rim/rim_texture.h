// What a ball's ink looks like along a line, learnt from its inside. Internal to host/circle.
#pragma once

#include <algorithm>
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
// As it looks in levels told by a paint that is less bright, by this factor.
void brighten(RimTexture& texture, double by);

// Learns a texture from windows of the ball's inside.
class TextureSums {
 public:
  // `least`: levels below are cut off.
  explicit TextureSums(float least) : least_(least) {}
  // kTexture samples from the innermost on, 0 background, 1 bare paint.
  void add(const float* samples, float noise);
  // `paint_sd`: of the level of bare paint from place to place.
  RimTexture result(double paint_sd) const;
  // Share of the samples that are bare paint.
  double bare_share() const { return bare_ / std::max(windows_ * kTexture, 1.0); }
  // Mean of the innermost samples of windows that show more than ink, as lines must; 0 of none.
  double shown_inside() const { return shown_sum_ / std::max(shown_, 1.0); }

 private:
  struct Sums {
    double n = 0;
    double sum[kTexture] = {}, product[kTexture][kTexture] = {};
  };
  float least_;
  double windows_ = 0, bare_ = 0, shown_ = 0, shown_sum_ = 0;
  std::array<Sums, kKinds> kinds_;
};

}  // namespace impactdic::circle
