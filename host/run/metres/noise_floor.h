// The noise floor of displacements: what is measured of a still scene.
#pragma once

#include <impactdic/correlate.h>

#include <span>
#include <vector>

#include "host/dic/field.h"

namespace impactdic::run {

// Gathers the frames with which a clip begins, as long as nothing moves in them.
class StillFrames {
 public:
  // `reach_px`: from the region's centre to its corners.
  StillFrames(ReferenceFrame reference, double reach_px)
      : reference_(reference), reach_px_(reach_px) {}

  // The next frame. What comes behind one that has moved is not looked at.
  void add(const MotionRow& row, std::span<const WindowMotion> field);

  // nullopt where fewer than three frames are still, or where all of them creep: where the slopes
  // of displacement over time are too steep for chance.
  std::optional<NoiseFloor> floor() const;

 private:
  // Of one component at one window.
  struct Series {
    double now = 0;                                  // displacement since the first frame
    double sum = 0, squares = 0;                     // of what was measured
    double place = 0, place_squares = 0, drift = 0;  // of `now`; the last weighted with the frame
    void add(double measured, bool from_first, int frame);
    double variance(int frames) const;
    // Square of the slope over its variance, both times the variance about the line.
    double slope_squared(int frames) const;
    double variance_about_line(int frames) const;
  };
  struct AtWindow {
    int frames = 0;
    Series u, v;
  };
  bool is_still(const MotionRow& row, double spatial_variance, std::size_t windows) const;
  bool creeps() const;

  ReferenceFrame reference_;
  double reach_px_;
  bool ended_ = false;
  int frames_ = 0;  // without the reference
  NoiseFloor found_;
  std::vector<AtWindow> windows_;
  std::vector<double> x_, y_;  // rigid motion since the first frame, px
  double rot_deg_ = 0;
  double spatial_u_ = 0, spatial_v_ = 0, stated_u_ = 0, stated_v_ = 0;  // sums of variances
};

}  // namespace impactdic::run
