// Where a sphere's centre is, told by its turns.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "host/dic/device/ball.h"
#include "host/dic/frames/device_frames.h"
#include "host/motion/pose/keyframe_plan.h"

namespace impactdic::motion {

// By how much a frame's circle lies to the right of the ball's centre and below it, px, with the
// deviations. `frame`: among those given.
struct TurnedCentre {
  std::size_t frame = 0;
  double off_x_px = 0, off_y_px = 0, x_sd_px = 0, y_sd_px = 0;
};

// Registers frames against others between which the ball has turned far out of the picture's
// plane, with its centre free: a point beside the centre lies at another depth, and a turn carries
// it elsewhere. Light and ink at the rim, which misplace circles, have no part in that.
class TurnedCentres {
 public:
  // `body`: the sphere as it is registered (body_options). All must outlive the object.
  TurnedCentres(opencl::Engine& engine, dic::DeviceFrames& frames, const KeyframeAim& aim,
                const dic::BallOptions& body)
      : frames_(frames), aim_(aim), free_(engine, with_free_centre(body)) {}

  static dic::BallOptions with_free_centre(dic::BallOptions body);

  // Of consecutive frames, whose motions are known, one in some: those of which a far turn tells.
  std::vector<TurnedCentre> measure(std::span<const ChainedFrame> frames);

 private:
  dic::DeviceFrames& frames_;
  const KeyframeAim& aim_;
  dic::BallRegistration free_;
};

}  // namespace impactdic::motion
