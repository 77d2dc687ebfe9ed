// Where the ball is and how far it has turned since the clip began, without drift: every frame is
// registered against the best of a few frames that are kept (keyframes), not only against the one
// before it. Steps from frame to frame add up their errors; a keyframe's do not grow.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "host/circle/circle.h"
#include "host/clip/track_row.h"
#include "host/motion/ball_crop.h"
#include "host/motion/keyframe_slots.h"
#include "host/motion/linked_pose.h"

namespace impactdic::motion {

// Keyframes that are kept: those of a whole turn, so that a ball meets them again.
inline constexpr int kKeyframes = 64;

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
// Of a sphere that tells how far keyframes reach, and the next ones are chosen before they are
// needed: registered, not placed by a step, and together with all frames that lean on them. A
// compressed ball's place among others is right, its picture is not that of the round ball: it is
// placed and becomes no keyframe, so that the poses after a contact lean on those before it.
// So a ball that turns in the picture's plane meets its first keyframe again after every turn, and
// one that rolls out of sight gets as few links of a chain as the pictures allow.
class Keyframes {
 public:
  // `radius_px` is the ball's, `crop` the size of the frames' parts. `sphere`: it turns about any
  // axis, and poses have orientations; `radius_sd_px` is then its radius's deviation.
  Keyframes(double radius_px, const BallCrop& crop, bool sphere, double radius_sd_px)
      : radius_px_(radius_px), crop_(crop), sphere_(sphere) {
    memory_.radius = {radius_px, radius_sd_px, 0, radius_sd_px};
  }

  // Poses of consecutive frames, the first of which may be the last one of the call before (it
  // then keeps its pose). Calls follow the order of the frames; `slots` may be another every time.
  std::vector<BodyPose> follow(std::span<const ChainedFrame> frames, KeyframeSlots& slots);

  struct Keyframe {
    LinkedPose pose;  // its own
    Circle circle;
    double residual = 0;         // of the best registration against it; 0 before the first
    std::int64_t last_used = 0;  // frame index
    int slot = 0;                // of 0 … kKeyframes − 1
  };
  // All that is known of the frames before, but for the pictures of the keyframes.
  struct Memory {
    std::vector<Keyframe> keyframes;  // oldest first
    LinkedPose last;                  // of frame last_index
    std::int64_t last_index = -1;
    SphereRadius radius;  // what the clip has told of a sphere's
    // Of a sphere: a frame that is tilted farther from its keyframe becomes one itself.
    double reach_rad = std::numeric_limits<double>::infinity();
  };
  const Memory& memory() const { return memory_; }
  // Goes on as those would whose memory this was; `read` gives the picture of a frame index.
  void restore(Memory memory, const std::function<Frame(std::int64_t)>& read);

  int made() const { return made_; }  // keyframes so far

 private:
  // What a frame is registered against: a keyframe, or a frame of the same call that becomes one.
  struct Target {
    Keyframe key;
    const ChainedFrame* frame = nullptr;
  };
  // The frame before those that are placed; none after a gap.
  struct Before {
    const ChainedFrame* frame = nullptr;
    const LinkedPose* pose = nullptr;
  };
  struct Plan {
    std::vector<Target> targets;
    std::vector<std::size_t> of;  // of every frame, its target
  };

  // Keeps the part of a keyframe's picture that goes to devices.
  void keep_picture(const Keyframe& key, const Frame& frame);
  // Puts a keyframe's picture on the device; returns its slot there.
  int hold(const Keyframe& key, KeyframeSlots& slots) const;
  // Makes `frame` the first keyframe of a new chain.
  LinkedPose begin(const ChainedFrame& frame);
  // Makes `frame` a keyframe, in place of the one that has been idle longest if need be.
  Keyframe keep(const ChainedFrame& frame, const LinkedPose& pose);
  // The pose of a frame to which no motion leads: found again, or a new chain's beginning.
  LinkedPose start(const ChainedFrame& frame, KeyframeSlots& slots);
  bool reaches(const Keyframe& key, const BodyPose& pose) const;
  std::size_t best_for(const BodyPose& pose, std::span<const Target> targets) const;
  // Which frames are to become keyframes, as far as the poses expected of them tell, so that all
  // are registered at once.
  Plan plan(std::span<const ChainedFrame> frames, std::span<const BodyPose> near) const;
  // Registers frames against their targets from the poses expected of them. Poses up to the first
  // that does not fit.
  std::vector<LinkedPose> place(std::span<const ChainedFrame> frames,
                                std::span<const BodyPose> near, const Before& before,
                                KeyframeSlots& slots);
  // What does not fit may be a ball under compression, or look otherwise than it did then.
  std::optional<LinkedPose> place_otherwise(const ChainedFrame& frame, const BodyPose& near,
                                            const Target& target, KeyframeSlots& slots);
  // Without its slots.
  BallTask task_of(const ChainedFrame& frame, const BodyPose& near, const Keyframe& key) const;
  BallMotion measure_one(const ChainedFrame& frame, const BodyPose& near, const Target& target,
                         bool affine, KeyframeSlots& slots);
  // Every frame against its target, in as few launches as the device's places allow.
  std::vector<BallMotion> measure(std::span<const ChainedFrame> frames,
                                  std::span<const BodyPose> near, const Plan& plan,
                                  KeyframeSlots& slots);
  // Of a frame that fits `key`, which takes note of it.
  LinkedPose pose_of(const ChainedFrame& frame, const BodyPose& near, const BallMotion& motion,
                     Keyframe& key);
  // Takes note of what the last pose, where it closes a turn, says of the radius: in the keyframes,
  // the plan and the poses that have been placed.
  void close_turn(const Before& last, std::vector<LinkedPose>& placed, Plan& plan);
  void learn_reach(const BodyPose& key, const BodyPose& near);
  bool fits(const BallMotion& motion, const Keyframe& key) const;
  // Looks for the ball after a gap: the turn by rings about the circles.
  std::optional<LinkedPose> find_again(const ChainedFrame& frame, KeyframeSlots& slots);
  // Motions from the keyframe to the frame that the pictures may show, likeliest first.
  std::vector<dic::RigidMotion> sought(const Keyframe& key, const ChainedFrame& frame,
                                       KeyframeSlots& slots);

  double radius_px_;
  BallCrop crop_;
  bool sphere_;
  Memory memory_;
  std::array<Frame, kKeyframes> pictures_;  // of the keyframes, cut, by their slots
  int made_ = 0;
};

}  // namespace impactdic::motion
