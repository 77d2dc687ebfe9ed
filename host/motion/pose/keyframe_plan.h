// Which keyframe every frame is registered against, and from where the registration starts.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "host/circle/circle.h"
#include "host/clip/track_row.h"
#include "host/dic/rigid_fit.h"
#include "host/motion/ball_crop.h"
#include "host/motion/ball_shape.h"
#include "host/motion/pose/keyframe_slots.h"
#include "host/motion/pose/linked_pose.h"

namespace impactdic::motion {

inline constexpr double kUsualCircleSd_px = 0.015;
// Of a sphere, the share of its surface that both pictures must see.
inline constexpr double kLeastSeen = 0.45;

// One frame in order, its circle, and the motion to the next one. `slot`: of its part on the
// device, whose corner is `origin`.
struct ChainedFrame {
  std::int64_t index = 0;  // among the analysed frames
  bool circle_ok = false;
  Circle circle;
  double circle_sd_px = kUsualCircleSd_px;  // of its centre, each way
  BallShape shape;
  const Frame* frame = nullptr;
  const dic::RigidMotion* next = nullptr;  // nullptr where it was not measured
  int slot = 0;
  CropOrigin origin;
};

struct Keyframe {
  LinkedPose pose;  // its own
  Circle circle;
  BallShape shape;             // only a chain that begins in contact has one that is compressed
  double residual = 0;         // of the best registration against it; 0 before the first
  std::int64_t last_used = 0;  // frame index
  // Of a sphere. How far its circle's centre lies to the right of the ball's and below it, px, as
  // closed turns tell, with its deviation; that of the circle itself.
  std::array<double, 2> off_px{};
  double off_sd_px = kUsualCircleSd_px, circle_sd_px = kUsualCircleSd_px;
  // Whether its pose is known from elsewhere than its links; how far it lies along the chain.
  bool anchored = false;
  double along_rad = 0;
  std::shared_ptr<const Frame> picture;  // the part of it that goes to devices
};

// What a frame is registered against: a keyframe, or a frame of the same call that becomes one.
struct Target {
  Keyframe key;
  const ChainedFrame* frame = nullptr;
};

struct KeyframePlan {
  std::vector<Target> targets;
  std::vector<std::size_t> of;  // of every frame, its target
};

class KeyframeAim {
 public:
  // `radius_px` is that of the ball's outline, `crop` the size of the frames' parts. A sphere turns
  // about any axis, and its poses have orientations; circles are then about its centre.
  KeyframeAim(double radius_px, const BallCrop& crop, const EstimatorOptions& options)
      : radius_px_(options.sphere ? options.sphere_radius(radius_px) : radius_px),
        rim_px_(radius_px),
        blur_px2_(options.sphere_blur_px2),
        light_(options.sphere_light),
        crop_(crop),
        sphere_(options.sphere),
        perspective_(options.perspective) {}

  double radius_px() const { return radius_px_; }
  bool sphere() const { return sphere_; }
  const Perspective& perspective() const { return perspective_; }
  const BallLight& light() const { return light_; }
  const BallCrop& crop() const { return crop_; }

  // The part of a keyframe's picture that goes to devices.
  std::shared_ptr<const Frame> picture_of(const Circle& circle, const Frame& frame) const;
  // Puts that on the device; returns its slot there.
  int hold(const Keyframe& key, KeyframeSlots& slots) const;
  // Gives every frame one of the targets. Where none reaches the pose expected of it (`near`), the
  // frame before it is to become a keyframe, as far as those poses tell, so that all can be
  // registered at once; it joins the targets. `reach_rad`: the farthest tilt of a sphere.
  void plan(std::span<const ChainedFrame> frames, std::span<const BodyPose> near, double reach_rad,
            KeyframePlan& plan) const;
  // The registration of a frame from the pose expected of it; without its slots.
  BallTask task_of(const ChainedFrame& frame, const BodyPose& near, const Keyframe& key) const;
  // Every frame against its target, in as few launches as the device's places allow.
  std::vector<BallMotion> measure(std::span<const ChainedFrame> frames,
                                  std::span<const BodyPose> near, const KeyframePlan& plan,
                                  KeyframeSlots& slots) const;
  BallMotion measure_one(const ChainedFrame& frame, const BodyPose& near, const Target& target,
                         bool affine, KeyframeSlots& slots) const;

 private:
  bool reaches(const Keyframe& key, const BodyPose& pose, double reach_rad) const;
  std::size_t best_for(const BodyPose& pose, std::span<const Target> targets,
                       double reach_rad) const;

  double radius_px_, rim_px_, blur_px2_;
  BallLight light_;
  BallCrop crop_;
  bool sphere_;
  Perspective perspective_;
};

}  // namespace impactdic::motion
