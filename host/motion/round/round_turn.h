// The turn of a body that is no sphere between two of its views: sought as a sphere's is, and made
// exact on the pictures.
#pragma once

#include <impactdic/image.h>

#include "host/dic/device/sphere_search.h"
#include "host/dic/rigid_fit.h"
#include "host/motion/round/round_view.h"

namespace impactdic::motion {

class RoundTurn {
 public:
  // `engine` must outlive it.
  RoundTurn(opencl::Engine& engine, const RoundFrame& round);

  // What the views do not show: how well the centres of both outlines are known, px, and the depth
  // of the surface's points, share of itself.
  struct Doubt {
    double centre_sd_px = 0, depth_sd = 0;
  };

  // From the first to the second view, with the light (may be empty) taken off both: the likeliest
  // turns of all SO(3), each led to where both views agree best. A surface whose middle seems to
  // move by some pixels seems to turn by as many over its mean depth; another shape than the
  // model's makes a turn out of the picture's plane longer or shorter and leads its axis aside, by
  // as much. dx, dy are 0; `ok` is false where no turn stands out.
  dic::RigidMotion measure(const RoundView& first, const RoundView& second, const RoundView& light,
                           const Doubt& doubt);

 private:
  RoundFrame round_;
  dic::DeviceFrames frames_;
  dic::SphereSearch search_;
};

}  // namespace impactdic::motion
