// The radius of a sphere, and from where it is seen, from two pictures between which it has turned
// far.
#pragma once

#include <functional>
#include <optional>

#include "host/advice/clip_advice.h"
#include "host/dic/rigid_fit.h"
#include "host/motion/perspective.h"
#include "host/sphere/picture_blur.h"
#include "kernels/types.h"

namespace impactdic::opencl {
class Engine;
}  // namespace impactdic::opencl

namespace impactdic::advice {

// The analysed frames, read one by one. Several threads may read at a time.
struct FarFrames {
  std::int64_t count = 0;
  int width = 0, height = 0;  // of the region of interest, px
  // The ball in frame `index`, looked for near a circle; nullopt where it is not found.
  std::function<std::optional<BallPicture>(std::int64_t index, const Circle& near)> find;
  // The same within some pixels of a circle alone.
  std::function<std::optional<FoundBall>(std::int64_t index, const Circle& guess)> find_near;
  // Frame `index`, cut to the region of interest; nullopt where it cannot be read.
  std::function<std::optional<Frame>(std::int64_t index)> picture;
};
// Both must outlive what is returned.
FarFrames far_frames(FrameSource& source, const AdviceRequest& request);

// What a sphere's pictures tell of it: its radius, camera pixels, and this over the distance of the
// camera, where that was not known.
struct SphereTold {
  Measured radius_px;
  std::optional<Measured> nearness;
  double blur_px2 = sphere::kUsualBlur_px2;  // of the pictures, see BallTask
  std::optional<BallLight> light;            // where it changes what the turn shows
};

// An error of the radius shows in proportion to the turn, and one of the distance. The first
// picture of `pair` is therefore registered, with the radius free, against one in which the ball,
// if it goes on moving by `step` a frame, has turned out of the picture's plane by some 25 degrees,
// or nearer ones where that fails: at an impact it does not go on. The displacement that the radius
// makes of such a turn must also be that of the circles. So is the distance free where it is not
// known: what is nearer moves by more in the picture than the turn makes it, and less than a larger
// radius would. Light that does not turn looks like depth: what the turn shows of the lamp is taken
// into account. nullopt where no picture a few frames away could be registered, and of a ball that
// is seen as an ellipse.
std::optional<SphereTold> sphere_from_turn(opencl::Engine& engine, const BallPair& pair,
                                           const dic::RigidMotion& step,
                                           const motion::EstimatorOptions& options,
                                           const FarFrames& frames);

}  // namespace impactdic::advice
