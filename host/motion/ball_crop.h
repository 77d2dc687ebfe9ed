// The part of every frame that goes to the device: a square about the ball. All of a clip's are of
// one size, so that slots stay alike; what is measured in them comes back in the frame's pixels.
#pragma once

#include <optional>

#include "host/dic/frames/device_frames.h"
#include "host/motion/motion_estimator.h"

namespace impactdic::motion {

// Pixel (0, 0) of a part, in the frame.
struct CropOrigin {
  int x = 0, y = 0;
};

class BallCrop {
 public:
  // `radius_px` is the ball's, width and height the frames'.
  BallCrop(const EstimatorOptions& options, double radius_px, int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }
  // About the ball as far as the frame's border allows.
  CropOrigin about(const Circle& ball) const;

 private:
  int frame_width_, frame_height_, width_, height_;
};

// Takes the circles of a pair that has still to be measured from the frames into their parts, and
// everything of a measured one back.
void into_crops(PairMotion& pair, const CropOrigin& first, const CropOrigin& second);
void out_of_crops(PairMotion& pair, const CropOrigin& first, const CropOrigin& second);

}  // namespace impactdic::motion
