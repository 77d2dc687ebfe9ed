// Where the ball is and how far it has turned since the clip began, without drift: every frame is
// registered against the best of a few frames that are kept (keyframes), not only against the one
// before it. Steps from frame to frame add up their errors; a keyframe's do not grow.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "host/motion/pose/chain_link.h"
#include "host/motion/pose/keyframe_plan.h"

namespace impactdic::motion {

// A sphere's keyframe is used up to this tilt: what a keyframe's circle errs by makes an error of
// the turn in proportion to the tilt, so that a chain of many short links errs less than one of few
// long ones.
inline constexpr double kFarthestTilt_rad = 0.105;
// Keyframes that are kept: those of a whole turn, so that a ball meets them again. They may lie
// half the farthest tilt apart.
inline constexpr int kKeyframes = 128;

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
  using Keyframe = motion::Keyframe;
  // `radius_sd_px`: of a sphere's radius, its deviation.
  Keyframes(const KeyframeAim& aim, double radius_sd_px) : aim_(aim) {
    memory_.radius = {aim.radius_px(), radius_sd_px, 0, radius_sd_px, aim.perspective()};
    memory_.radius.light = aim.light();
  }

  // All that is known of the frames before.
  struct Memory {
    std::vector<Keyframe> keyframes;  // oldest first
    LinkedPose last;                  // of frame last_index
    std::int64_t last_index = -1;
    SphereRadius radius;                       // what the clip has told of a sphere's
    std::vector<ChainLink> links;              // of a sphere's keyframes
    std::array<double, 15> link_covariance{};  // of the last registration
    // Of a sphere: a frame that is tilted farther from its keyframe becomes one itself.
    double reach_rad = kFarthestTilt_rad;
  };

  // Frames that were registered before the poses of those before them were known.
  struct Ahead {
    std::vector<ChainedFrame> frames;
    // Of frames[1] on: the poses that were expected, the keyframes, and what was measured. Fewer
    // than there are frames where no motion led on.
    std::vector<BodyPose> near;
    KeyframePlan plan;
    std::vector<BallMotion> motions;
  };

  // Poses of consecutive frames, the first of which may be the last one of the call before (it
  // then keeps its pose). Calls follow the order of the frames; `slots` may be another every time.
  std::vector<BodyPose> follow(std::span<const ChainedFrame> frames, KeyframeSlots& slots) {
    return follow(frames, nullptr, slots);
  }
  // The same for frames of which some have been registered: where their keyframes are what they
  // were expected to be, and they fit.
  std::vector<BodyPose> follow(const Ahead& ahead, KeyframeSlots& slots) {
    return follow(ahead.frames, &ahead, slots);
  }

  const Memory& memory() const { return memory_; }
  // Goes on as those would whose memory this was, but for its pictures; `read` gives the picture of
  // a frame index.
  void restore(Memory memory, const std::function<Frame(std::int64_t)>& read);

  int made() const { return made_; }  // keyframes so far

 private:
  // The frame before those that are placed; none after a gap.
  struct Before {
    const ChainedFrame* frame = nullptr;
    const LinkedPose* pose = nullptr;
  };
  // Frames to be placed next: the poses expected of them, and registrations against a plan's
  // targets.
  struct Registered {
    std::vector<BodyPose> near;
    KeyframePlan plan;
    std::vector<BallMotion> motions;
  };

  // Makes `frame` the first keyframe of a new chain.
  LinkedPose begin(const ChainedFrame& frame);
  // Makes `frame` a keyframe, in place of the one that has been idle longest if need be.
  // `link`: how it hangs on another one; else its pose is known by itself.
  Keyframe keep(const ChainedFrame& frame, const LinkedPose& pose,
                const std::optional<ChainLink>& link = {});
  // What leads from a keyframe to a frame that leans on `pose`'s, and by its motion to `next`; with
  // `closed`, back to the keyframe that `next` was found against. Empty of a flat ball, and where a
  // frame was not registered.
  std::optional<ChainLink> link_to(std::int64_t next, const LinkedPose& pose,
                                   const ChainedFrame* step, const LinkedPose* closed) const;
  // The pose of a frame to which no motion leads: found again, or a new chain's beginning. `near`:
  // where it may be, if anything tells.
  LinkedPose start(const ChainedFrame& frame, const std::optional<BodyPose>& near,
                   KeyframeSlots& slots);
  std::vector<BodyPose> follow(std::span<const ChainedFrame> frames, const Ahead* ahead,
                               KeyframeSlots& slots);
  // Poses expected of at most `most` frames from `first` on, up to one that has been registered.
  std::vector<BodyPose> expected(std::span<const ChainedFrame> frames, std::size_t first,
                                 std::size_t most, const LinkedPose& before, const Ahead* ahead,
                                 const std::set<std::size_t>& failed) const;
  // Registers the first frames, as many as `near` expects poses of, against keyframes. Those that
  // `ahead` has others lean on become keyframes, too.
  Registered measure(std::span<const ChainedFrame> frames, std::vector<BodyPose> near,
                     const Ahead* ahead, KeyframeSlots& slots) const;
  const Keyframe* find(std::int64_t frame) const;
  // Whether what frame `i` was registered against ahead is a keyframe, or will be one when those
  // from `first` on are placed.
  bool is_known(const Ahead& ahead, std::size_t i, std::size_t first) const;
  // What was registered ahead of the frames from `first` on, as far as its keyframes are known and
  // have not failed.
  Registered registered_ahead(const Ahead& ahead, std::size_t first,
                              const std::set<std::size_t>& failed, const LinkedPose& before) const;
  // Poses up to the first frame that does not fit; `earlier`: those that were placed before.
  std::vector<LinkedPose> place(std::span<const ChainedFrame> frames, Registered& registered,
                                const Before& before, std::span<LinkedPose> earlier,
                                KeyframeSlots& slots);
  // What does not fit may be a ball under compression, or look otherwise than it did then.
  std::optional<LinkedPose> place_otherwise(const ChainedFrame& frame, const BodyPose& near,
                                            const Target& target, KeyframeSlots& slots);
  // Of a frame that fits `key`, which takes note of it.
  LinkedPose pose_of(const ChainedFrame& frame, const BodyPose& near, const BallMotion& motion,
                     Keyframe& key);
  // Takes note of what the last pose, where it closes a turn, says of those before it: in the
  // keyframes, the plan and the poses that have been placed.
  void close_turn(const Before& last, std::span<LinkedPose> earlier,
                  std::vector<LinkedPose>& placed, KeyframePlan& plan);
  void learn_reach(const BodyPose& key, const BodyPose& near);
  // Whether a rigid registration would err: a flat ball whose shape is another than a circle.
  bool is_strained(const ChainedFrame& frame, const Keyframe& key) const;
  bool fits(const BallMotion& motion, const Keyframe& key) const;
  // Looks for the ball after a gap: near `near`, and by the turn of rings about the circles.
  std::optional<LinkedPose> find_again(const ChainedFrame& frame,
                                       const std::optional<BodyPose>& near, KeyframeSlots& slots);
  std::optional<LinkedPose> find_near(const ChainedFrame& frame, const BodyPose& near,
                                      KeyframeSlots& slots);
  // Motions from the keyframe to the frame that the pictures may show, likeliest first.
  std::vector<dic::RigidMotion> sought(const Keyframe& key, const ChainedFrame& frame,
                                       KeyframeSlots& slots);

  KeyframeAim aim_;
  Memory memory_;
  int made_ = 0;
};

}  // namespace impactdic::motion
