// Where the ball is and how far it has turned since the clip began, without drift: every frame is
// registered against the best of a few frames that are kept (keyframes), not only against the one
// before it. Steps from frame to frame add up their errors; a keyframe's do not grow.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "host/circle/circle.h"
#include "host/clip/track_row.h"
#include "host/dic/device/ball.h"
#include "host/dic/device/ring.h"
#include "host/dic/device/sphere_search.h"
#include "host/dic/frames/device_frames.h"
#include "host/motion/ball_crop.h"
#include "host/opencl/engine.h"

namespace impactdic::motion {

// Keyframes at a time.
inline constexpr int kKeyframes = 8;

// Where frames are registered against keyframes: whoever has the frames on its device. The
// keyframes' pictures stand in the kKeyframes slots from `first_slot` on.
class KeyframeSlots {
 public:
  // `engine` and `frames` must outlive the object.
  // `options.model`: kRigid of a flat ball (affine where it is compressed), or kSphere.
  KeyframeSlots(opencl::Engine& engine, dic::DeviceFrames& frames, int first_slot,
                const dic::BallOptions& options);

  // Puts the picture of keyframe `index` into place `place` unless it is there.
  void hold(int place, std::int64_t index, const Frame& picture);
  int slot(int place) const { return first_slot_ + place; }
  std::vector<BallMotion> measure(std::span<const BallTask> tasks, bool affine);
  dic::RingMotion turn(const RingTask& task);
  // Turns of a sphere, likeliest first.
  std::vector<dic::SphereTurn> turns(const SphereSearchTask& task);

 private:
  dic::DeviceFrames& frames_;
  int first_slot_;
  dic::BallRegistration rigid_, affine_;
  dic::RingRotation ring_;
  dic::SphereSearch search_;
  std::array<std::int64_t, kKeyframes> held_;  // frame indices, −1: none
};

// One frame in order, its circle, and the motion to the next one. `slot`: of its part on the
// device, whose corner is `origin`.
struct ChainedFrame {
  std::int64_t index = 0;  // among the analysed frames
  bool circle_ok = false;
  bool compressed = false;  // plainly no circle: in contact
  Circle circle;
  const Frame* frame = nullptr;
  const dic::RigidMotion* next = nullptr;  // nullptr where it was not measured
  int slot = 0;
  CropOrigin origin;
};

// The first frame with a ball is the first keyframe. A frame is registered against the keyframe
// whose turn is nearest to its own (lamp and shadow look alike then); where that no longer fits as
// well as it did, it is placed by the motion from the frame before and becomes a keyframe itself.
// A compressed ball's place among others is right, its picture is not that of the round ball: it is
// placed and becomes no keyframe, so that the poses after a contact lean on those before it.
// So a ball that turns in the picture's plane meets its first keyframe again after every turn, and
// one that rolls out of sight gets as few links of a chain as the pictures allow.
class Keyframes {
 public:
  // `radius_px` is the ball's, `crop` the size of the frames' parts. `sphere`: it turns about any
  // axis, and poses have orientations; `radius_sd_px` is then its radius's deviation.
  Keyframes(double radius_px, const BallCrop& crop, bool sphere, double radius_sd_px)
      : radius_px_(radius_px), radius_sd_px_(radius_sd_px), crop_(crop), sphere_(sphere) {}

  // Poses of consecutive frames, the first of which may be the last one of the call before (it
  // then keeps its pose). Calls follow the order of the frames; `slots` may be another every time.
  std::vector<BodyPose> follow(std::span<const ChainedFrame> frames, KeyframeSlots& slots);

  struct Keyframe {
    BodyPose pose;  // its own
    Circle circle;
    double residual = 0;         // of the best registration against it; 0 before the first
    std::int64_t last_used = 0;  // frame index
    int slot = 0;                // of 0 … kKeyframes − 1
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
  struct Placed {
    bool fits = false;
    BodyPose pose;
  };

  // Keeps the part of a keyframe's picture that goes to devices.
  void keep_picture(const Keyframe& key, const Frame& frame);
  // Puts a keyframe where `slots` needs it; returns the slot.
  int hold(const Keyframe& key, KeyframeSlots& slots) const;
  // Makes `frame` the first keyframe of a new chain.
  BodyPose begin(const ChainedFrame& frame);
  // Makes `frame` a keyframe, in place of the one that has been idle longest if need be.
  BodyPose keep(const ChainedFrame& frame, const BodyPose& pose);
  // The pose of a frame to which no motion leads: found again, or a new chain's beginning.
  BodyPose start(const ChainedFrame& frame, KeyframeSlots& slots);
  std::size_t best_for(const BodyPose& pose) const;
  // Registers frames against their best keyframes from the poses expected of them, up to the first
  // that fits none.
  std::vector<Placed> place(std::span<const ChainedFrame> frames, std::span<const BodyPose> near,
                            KeyframeSlots& slots);
  std::vector<BallMotion> measure(std::span<const ChainedFrame> frames,
                                  std::span<const BodyPose> near, std::span<const std::size_t> keys,
                                  bool affine, KeyframeSlots& slots);
  bool fits(const BallMotion& motion, std::size_t key) const;
  // Looks for the ball after a gap: the turn by rings about the circles.
  Placed find_again(const ChainedFrame& frame, KeyframeSlots& slots);
  // Motions from the keyframe to the frame that the pictures may show, likeliest first.
  std::vector<dic::RigidMotion> sought(const Keyframe& key, const ChainedFrame& frame,
                                       KeyframeSlots& slots);

  double radius_px_, radius_sd_px_;
  BallCrop crop_;
  bool sphere_;
  Memory memory_;
  std::array<Frame, kKeyframes> pictures_;  // of the keyframes, cut, by their slots
  int made_ = 0;
};

}  // namespace impactdic::motion
