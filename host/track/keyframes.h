// Where the ball is and how far it has turned since the clip began, without drift: every frame is
// registered against the best of a few frames that are kept (keyframes), not only against the one
// before it. Steps from frame to frame add up their errors; a keyframe's do not grow.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "host/dic/ball_registration.h"
#include "host/dic/device_frames.h"
#include "host/dic/ring.h"
#include "host/opencl/engine.h"
#include "host/track/circle.h"
#include "host/track/track_row.h"

namespace impactdic {

// One frame in order, its circle, and the motion to the next one.
struct ChainedFrame {
  std::int64_t index = 0;  // among the analysed frames
  bool circle_ok = false;
  Circle circle;
  const Frame* frame = nullptr;
  const RigidMotion* next = nullptr;  // nullptr where it was not measured
};

// The first frame with a ball is the first keyframe. A frame is registered against the keyframe
// whose turn is nearest to its own (lamp and shadow look alike then); where that no longer fits as
// well as it did, it is placed by the motion from the frame before and becomes a keyframe itself.
// So a ball that turns in the picture's plane meets its first keyframe again after every turn, and
// one that rolls out of sight gets as few links of a chain as the pictures allow.
class Keyframes {
 public:
  // Works on a queue of its own beside `engine`'s. `radius_px` is the ball's.
  Keyframes(const Engine& engine, const BallOptions& options, double radius_px);

  // Poses of consecutive frames, the first of which may be the last one of the call before (it
  // then keeps its pose).
  std::vector<BodyPose> follow(std::span<const ChainedFrame> frames);

  struct Keyframe {
    BodyPose pose;  // its own
    Circle circle;
    double residual = 0;         // of the best registration against it; 0 before the first
    std::int64_t last_used = 0;  // frame index
    int slot = 0;
  };
  // All that is known of the frames before, but for the pictures of the keyframes.
  struct Memory {
    std::vector<Keyframe> keyframes;  // oldest first
    BodyPose last;                    // of frame last_index
    std::int64_t last_index = -1;
  };
  const Memory& memory() const { return memory_; }
  // Goes on as those would whose memory this was; `read` gives the picture of a frame index.
  void restore(Memory memory, const std::function<Frame(std::int64_t)>& read);

  int made() const { return made_; }  // keyframes so far

 private:
  static constexpr std::size_t kKept = 8;     // keyframes at a time, in the first slots
  static constexpr std::size_t kAtOnce = 16;  // frames that are registered together, behind them

  struct Placed {
    bool fits = false;
    BodyPose pose;
  };

  // Makes `frame` the first keyframe of a new chain.
  BodyPose begin(const ChainedFrame& frame);
  // Makes `frame` a keyframe, in place of the one that has been idle longest if need be.
  BodyPose keep(const ChainedFrame& frame, const BodyPose& pose);
  // The pose of a frame to which no motion leads: found again, or a new chain's beginning.
  BodyPose start(const ChainedFrame& frame);
  std::size_t best_for(double angle_rad) const;
  // Registers frames (kAtOnce at most) against their best keyframes from the poses expected of
  // them, up to the first that fits none.
  std::vector<Placed> place(std::span<const ChainedFrame> frames, std::span<const BodyPose> near);
  // The same of frames that are on the device, the first of them `first` of those placed together.
  std::vector<BallMotion> measure(BallRegistration& registration, std::size_t first,
                                  std::span<const BodyPose> near,
                                  std::span<const std::size_t> keys);
  bool fits(const BallMotion& motion, std::size_t key) const;
  // Looks for the ball after a gap: the turn by rings about the circles.
  Placed find_again(const ChainedFrame& frame);

  std::unique_ptr<Engine> engine_;
  DeviceFrames frames_;
  double radius_px_;
  BallRegistration rigid_, affine_;
  RingRotation ring_;
  Memory memory_;
  int made_ = 0;
};

}  // namespace impactdic
