#include "host/motion/pose/keyframe_plan.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "host/clip/roi.h"
#include "host/dic/sphere/rotation.h"
#include "host/motion/estimators.h"
#include "host/motion/pose/body_motion.h"

namespace impactdic::motion {
namespace {

// Of keyframes whose turns differ by less, the oldest has the shortest chain behind it.
constexpr double kAlike_rad = 0.1;

}  // namespace

std::shared_ptr<const Frame> KeyframeAim::picture_of(const Circle& circle,
                                                     const Frame& frame) const {
  const CropOrigin origin = crop_.about(circle);
  auto picture = std::make_shared<Frame>();
  impactdic::crop(frame, {origin.x, origin.y, crop_.width(), crop_.height()}, *picture);
  return picture;
}

int KeyframeAim::hold(const Keyframe& key, KeyframeSlots& slots) const {
  return slots.hold(key.pose.keyframe, *key.picture, crop_.about(key.circle));
}

bool KeyframeAim::reaches(const Keyframe& key, const BodyPose& pose, double reach_rad) const {
  return !sphere_ || tilt_between(key.pose, pose) <= reach_rad;
}

std::size_t KeyframeAim::best_for(const BodyPose& pose, std::span<const Target> targets,
                                  double reach_rad) const {
  // Half a turn more where the pose is out of reach.
  const auto away = [&](const Keyframe& key) {
    if (!sphere_) return std::abs(std::remainder(key.pose.angle_rad - pose.angle_rad, 2 * kPi));
    const double angle = orientation(key.pose).angularDistance(orientation(pose));
    return reaches(key, pose, reach_rad) ? angle : angle + kPi;
  };
  std::vector<double> angles;
  for (const Target& target : targets) angles.push_back(away(target.key));
  const double alike = *std::min_element(angles.begin(), angles.end()) + kAlike_rad;
  const auto oldest =
      std::find_if(angles.begin(), angles.end(), [&](double angle) { return angle <= alike; });
  return static_cast<std::size_t>(oldest - angles.begin());
}

void KeyframeAim::plan(std::span<const ChainedFrame> frames, std::span<const BodyPose> near,
                       double reach_rad, KeyframePlan& plan) const {
  for (std::size_t i = 0; i < near.size(); ++i) {
    std::size_t best = best_for(near[i], plan.targets, reach_rad);
    if (i > 0 && !reaches(plan.targets[best].key, near[i], reach_rad) &&
        !frames[i - 1].shape.is_compressed() && plan.targets.back().frame != &frames[i - 1]) {
      Target before;
      static_cast<BodyPose&>(before.key.pose) = near[i - 1];
      before.key.pose.keyframe = frames[i - 1].index;
      before.key.circle = frames[i - 1].circle;
      before.key.shape = frames[i - 1].shape;
      before.frame = &frames[i - 1];
      plan.targets.push_back(before);
      best = plan.targets.size() - 1;
    }
    plan.of.push_back(best);
  }
}

BallTask KeyframeAim::task_of(const ChainedFrame& frame, const BodyPose& near,
                              const Keyframe& key) const {
  const CropOrigin origin = crop_.about(key.circle);
  const int u = frame.origin.x - origin.x, v = frame.origin.y - origin.y;
  const double arm_x = key.circle.cx_px - key.pose.x_px;
  const double arm_y = key.circle.cy_px - key.pose.y_px;
  const Circle cut{key.circle.cx_px - origin.x, key.circle.cy_px - origin.y, key.circle.r_px};
  BallTask task{};
  if (sphere_) {
    const Eigen::Quaterniond turn = turn_between(key.pose, near);
    const Point arm = turned(arm_x, arm_y, turn);
    const Eigen::Vector3d vector = dic::rotation_vector(turn);
    dic::RigidMotion start;
    start.dx_px = near.x_px + arm.x - key.circle.cx_px - u;
    start.dy_px = near.y_px + arm.y - key.circle.cy_px - v;
    start.rot_x_rad = vector.x();
    start.rot_y_rad = vector.y();
    start.rot_rad = vector.z();
    task = sphere_task(cut, radius_px_, blur_px2_, start);
    task.light = light_;
    task.sight =
        sight_of(perspective_, rim_px_, {key.circle, key.shape}, {frame.circle, frame.shape},
                 cut.cx_px + frame.origin.x, cut.cy_px + frame.origin.y);
  } else {
    const double turn = near.angle_rad - key.pose.angle_rad;
    const Point arm = turned(arm_x, arm_y, turn);
    task.cx = static_cast<float>(cut.cx_px);
    task.cy = static_cast<float>(cut.cy_px);
    task.radius = static_cast<float>(radius_px_ - dic::kRimMarginPx);
    task.guess_dx = static_cast<float>(near.x_px + arm.x - key.circle.cx_px - u);
    task.guess_dy = static_cast<float>(near.y_px + arm.y - key.circle.cy_px - v);
    task.guess_rot_rad = static_cast<float>(std::remainder(turn, 2 * kPi));
  }
  return task;
}

BallMotion KeyframeAim::measure_one(const ChainedFrame& frame, const BodyPose& near,
                                    const Target& target, bool affine, KeyframeSlots& slots) const {
  BallTask task = task_of(frame, near, target.key);
  task.first = target.frame != nullptr ? target.frame->slot : hold(target.key, slots);
  task.second = frame.slot;
  return slots.measure({&task, 1}, affine)[0];
}

std::vector<BallMotion> KeyframeAim::measure(std::span<const ChainedFrame> frames,
                                             std::span<const BodyPose> near,
                                             const KeyframePlan& plan, KeyframeSlots& slots) const {
  std::vector<BallMotion> motions;
  std::vector<BallTask> tasks;
  std::set<std::size_t> held;  // targets of those tasks that take a place
  const auto launch = [&] {
    const std::vector<BallMotion> some = slots.measure(tasks, false);
    motions.insert(motions.end(), some.begin(), some.end());
    tasks.clear();
    held.clear();
  };
  for (std::size_t i = 0; i < near.size(); ++i) {
    const Target& target = plan.targets[plan.of[i]];
    if (target.frame == nullptr && held.insert(plan.of[i]).second &&
        held.size() > kKeyframePlaces) {
      launch();
      held.insert(plan.of[i]);
    }
    BallTask task = task_of(frames[i], near[i], target.key);
    task.first = target.frame != nullptr ? target.frame->slot : hold(target.key, slots);
    task.second = frames[i].slot;
    tasks.push_back(task);
  }
  launch();
  return motions;
}

}  // namespace impactdic::motion
