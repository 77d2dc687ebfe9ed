#include "host/motion/keyframes.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "host/clip/roi.h"
#include "host/dic/sphere/rotation.h"
#include "host/motion/body_motion.h"
#include "host/motion/estimators.h"
#include "host/motion/turn_closure.h"

namespace impactdic::motion {
namespace {

// A residual this many times the keyframe's best one is more than noise: interpolation alone makes
// it vary by a fifth.
constexpr double kMisfit = 1.5;
constexpr double kSamePicture = 0.5;
// Frames that are registered together behind one that did not fit: likely the next does not either.
constexpr std::size_t kFewAtOnce = 4;
// Of keyframes whose turns differ by less, the oldest has the shortest chain behind it.
constexpr double kAlike_rad = 0.1;

// Of a sphere, the share of its surface that both pictures must see.
constexpr double kLeastSeen = 0.45;
// A keyframe is used up to this share of the tilt at which one no longer fitted, and at least to
// this tilt: nearer, it was something else than foreshortening. Wherever all frames fit, the reach
// grows by the last of these.
constexpr double kReach = 0.8, kLeastReach_rad = 0.1, kGrowth = 1.02;
// A frame has come round where a keyframe's chain holds less than this share of the radius's effect
// on the frame before.
constexpr double kCloser = 0.7;

}  // namespace

void Keyframes::restore(Memory memory, const std::function<Frame(std::int64_t)>& read) {
  if (memory.radius.px == 0) memory.radius = memory_.radius;  // of an older version
  memory_ = std::move(memory);
  for (const Keyframe& key : memory_.keyframes) keep_picture(key, read(key.pose.keyframe));
}

void Keyframes::keep_picture(const Keyframe& key, const Frame& frame) {
  const CropOrigin origin = crop_.about(key.circle);
  crop(frame, {origin.x, origin.y, crop_.width(), crop_.height()},
       pictures_.at(static_cast<std::size_t>(key.slot)));
}

int Keyframes::hold(const Keyframe& key, KeyframeSlots& slots) const {
  return slots.hold(key.pose.keyframe, pictures_.at(static_cast<std::size_t>(key.slot)));
}

LinkedPose Keyframes::begin(const ChainedFrame& frame) {
  memory_.keyframes.clear();
  LinkedPose pose;
  pose.ok = true;
  pose.x_px = frame.circle.cx_px;
  pose.y_px = frame.circle.cy_px;
  pose.angle_rad = pose.x_sd_px = pose.y_sd_px = pose.angle_sd_rad = 0;
  if (sphere_) {
    pose.angle_rad = kNotMeasured;
    pose.tilt_x_sd_rad = pose.tilt_y_sd_rad = 0;
    set_orientation(pose, Eigen::Quaterniond::Identity());
  }
  pose.origin = frame.index;
  return keep(frame, pose).pose;
}

Keyframes::Keyframe Keyframes::keep(const ChainedFrame& frame, const LinkedPose& pose) {
  Keyframe made;
  made.pose = pose;
  made.pose.keyframe = frame.index;
  made.circle = frame.circle;
  made.last_used = frame.index;
  ++made_;
  if (memory_.keyframes.size() == kKeyframes) {
    const auto idle = std::min_element(
        memory_.keyframes.begin(), memory_.keyframes.end(),
        [](const Keyframe& a, const Keyframe& b) { return a.last_used < b.last_used; });
    made.slot = idle->slot;
    memory_.keyframes.erase(idle);
  } else {
    made.slot = static_cast<int>(memory_.keyframes.size());
  }
  memory_.keyframes.push_back(made);
  keep_picture(made, *frame.frame);
  return made;
}

bool Keyframes::reaches(const Keyframe& key, const BodyPose& pose) const {
  return !sphere_ || tilt_between(key.pose, pose) <= memory_.reach_rad;
}

std::size_t Keyframes::best_for(const BodyPose& pose, std::span<const Target> targets) const {
  // Half a turn more where the pose is out of reach.
  const auto away = [&](const Keyframe& key) {
    if (!sphere_) return std::abs(std::remainder(key.pose.angle_rad - pose.angle_rad, 2 * kPi));
    const double angle = orientation(key.pose).angularDistance(orientation(pose));
    return reaches(key, pose) ? angle : angle + kPi;
  };
  std::vector<double> angles;
  for (const Target& target : targets) angles.push_back(away(target.key));
  const double alike = *std::min_element(angles.begin(), angles.end()) + kAlike_rad;
  const auto oldest =
      std::find_if(angles.begin(), angles.end(), [&](double angle) { return angle <= alike; });
  return static_cast<std::size_t>(oldest - angles.begin());
}

Keyframes::Plan Keyframes::plan(std::span<const ChainedFrame> frames,
                                std::span<const BodyPose> near) const {
  Plan plan;
  for (const Keyframe& key : memory_.keyframes) plan.targets.push_back({key, nullptr});
  for (std::size_t i = 0; i < frames.size(); ++i) {
    std::size_t best = best_for(near[i], plan.targets);
    if (i > 0 && !reaches(plan.targets[best].key, near[i]) && !frames[i - 1].compressed &&
        plan.targets.back().frame != &frames[i - 1]) {
      Target before;
      static_cast<BodyPose&>(before.key.pose) = near[i - 1];
      before.key.circle = frames[i - 1].circle;
      before.frame = &frames[i - 1];
      plan.targets.push_back(before);
      best = plan.targets.size() - 1;
    }
    plan.of.push_back(best);
  }
  return plan;
}

BallTask Keyframes::task_of(const ChainedFrame& frame, const BodyPose& near,
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
    task = sphere_task(cut, radius_px_, start);
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

BallMotion Keyframes::measure_one(const ChainedFrame& frame, const BodyPose& near,
                                  const Target& target, bool affine, KeyframeSlots& slots) {
  BallTask task = task_of(frame, near, target.key);
  task.first = target.frame != nullptr ? target.frame->slot : hold(target.key, slots);
  task.second = frame.slot;
  return slots.measure({&task, 1}, affine)[0];
}

std::vector<BallMotion> Keyframes::measure(std::span<const ChainedFrame> frames,
                                           std::span<const BodyPose> near, const Plan& plan,
                                           KeyframeSlots& slots) {
  std::vector<BallMotion> motions;
  std::vector<BallTask> tasks;
  std::set<std::size_t> held;  // targets of those tasks that take a place
  const auto launch = [&] {
    const std::vector<BallMotion> some = slots.measure(tasks, false);
    motions.insert(motions.end(), some.begin(), some.end());
    tasks.clear();
    held.clear();
  };
  for (std::size_t i = 0; i < frames.size(); ++i) {
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

std::vector<LinkedPose> Keyframes::place(std::span<const ChainedFrame> frames,
                                         std::span<const BodyPose> near, const Before& before,
                                         KeyframeSlots& slots) {
  Plan plan = this->plan(frames, near);
  const std::vector<BallMotion> motions = measure(frames, near, plan, slots);
  std::vector<LinkedPose> placed;
  std::size_t next = memory_.keyframes.size();  // of the targets that are to become keyframes
  for (std::size_t i = 0; i < frames.size(); ++i) {
    Target& target = plan.targets[plan.of[i]];
    if (fits(motions[i], target.key)) {
      placed.push_back(pose_of(frames[i], near[i], motions[i], target.key));
    } else if (const auto pose = place_otherwise(frames[i], near[i], target, slots)) {
      placed.push_back(*pose);
    } else {
      learn_reach(target.key.pose, near[i]);
      break;
    }
    const Before last = i == 0 ? before : Before{&frames[i - 1], &placed[i - 1]};
    if (sphere_ && last.pose != nullptr) close_turn(last, placed, plan);
    if (next < plan.targets.size() && plan.targets[next].frame == &frames[i]) {
      plan.targets[next++].key = keep(frames[i], placed.back());
    }
  }
  if (placed.size() == frames.size()) memory_.reach_rad *= kGrowth;
  return placed;
}

std::optional<LinkedPose> Keyframes::place_otherwise(const ChainedFrame& frame,
                                                     const BodyPose& near, const Target& target,
                                                     KeyframeSlots& slots) {
  const auto tried = [&](Target other, bool affine) -> std::optional<LinkedPose> {
    const BallMotion motion = measure_one(frame, near, other, affine, slots);
    if (!fits(motion, other.key)) return std::nullopt;
    return pose_of(frame, near, motion, other.key);
  };
  // A sphere's compression has no model.
  std::optional<LinkedPose> pose;
  if (!sphere_) pose = tried(target, true);
  const Keyframe& newest = memory_.keyframes.back();
  if (pose || newest.pose.keyframe == target.key.pose.keyframe) return pose;
  pose = tried({newest, nullptr}, false);
  if (!pose && !sphere_) pose = tried({newest, nullptr}, true);
  return pose;
}

LinkedPose Keyframes::pose_of(const ChainedFrame& frame, const BodyPose& near,
                              const BallMotion& motion, Keyframe& key) {
  const double residual = motion.residual;
  // A residual far below the best is no better fit but the same picture once more: a clip that
  // repeats itself, a camera that stored a frame twice.
  const bool lower = residual < key.residual && residual > kSamePicture * key.residual;
  if (key.residual == 0 || lower) key.residual = residual;
  key.last_used = frame.index;
  for (Keyframe& kept : memory_.keyframes) {
    if (kept.pose.keyframe != key.pose.keyframe) continue;
    kept.residual = key.residual;
    kept.last_used = key.last_used;
  }
  const CropOrigin origin = crop_.about(key.circle);
  return registered(key.pose, key.circle, motion, frame.origin.x - origin.x,
                    frame.origin.y - origin.y, near.angle_rad, memory_.radius);
}

void Keyframes::close_turn(const Before& last, std::vector<LinkedPose>& placed, Plan& plan) {
  const auto length = [](const LinkedPose& pose) {
    const auto& g = pose.radius_turn_rad;
    return std::hypot(g[0], g[1], g[2]);
  };
  if (!(length(placed.back()) < kCloser * length(*last.pose))) return;
  const LinkedPose along =
      linked(*last.pose, last.frame->circle, *last.frame->next, memory_.radius);
  const auto better = radius_from(along, placed.back(), memory_.radius);
  if (!better) return;
  const double more_px = better->error_px - memory_.radius.error_px;
  const auto correct = [&](LinkedPose& pose) { pose = with_radius_error(pose, more_px); };
  for (Keyframe& key : memory_.keyframes) correct(key.pose);
  for (Target& target : plan.targets) correct(target.key.pose);
  for (LinkedPose& pose : placed) correct(pose);
  memory_.radius = *better;
}

void Keyframes::learn_reach(const BodyPose& key, const BodyPose& near) {
  if (!sphere_) return;
  memory_.reach_rad =
      std::min(memory_.reach_rad, std::max(kReach * tilt_between(key, near), kLeastReach_rad));
}

bool Keyframes::fits(const BallMotion& motion, const Keyframe& key) const {
  if (sphere_ && !(motion.used > kLeastSeen)) return false;
  return motion.status == static_cast<idic_int>(WindowStatus::kOk) &&
         (key.residual == 0 || motion.residual <= kMisfit * key.residual);
}

std::optional<LinkedPose> Keyframes::find_again(const ChainedFrame& frame, KeyframeSlots& slots) {
  const auto key = std::max_element(
      memory_.keyframes.begin(), memory_.keyframes.end(),
      [](const Keyframe& a, const Keyframe& b) { return a.last_used < b.last_used; });
  for (const dic::RigidMotion& motion : sought(*key, frame, slots)) {
    const std::vector<LinkedPose> found =
        place({&frame, 1}, std::vector{moved(key->pose, key->circle, motion)}, {}, slots);
    if (!found.empty()) return found[0];
  }
  return std::nullopt;
}

std::vector<dic::RigidMotion> Keyframes::sought(const Keyframe& key, const ChainedFrame& frame,
                                                KeyframeSlots& slots) {
  PairMotion pair;
  pair.first_slot = hold(key, slots);
  pair.second_slot = frame.slot;
  pair.first = key.circle;
  pair.second = frame.circle;
  into_crops(pair, crop_.about(key.circle), frame.origin);
  dic::RigidMotion motion;
  motion.dx_px = frame.circle.cx_px - key.circle.cx_px;
  motion.dy_px = frame.circle.cy_px - key.circle.cy_px;
  if (!sphere_) {
    const dic::RingMotion turn = slots.turn(ring_task(pair, radius_px_));
    if (turn.status != WindowStatus::kOk) return {};
    motion.rot_rad = turn.rot_rad;
    return {motion};
  }
  std::vector<dic::RigidMotion> motions;
  for (const dic::SphereTurn& found : slots.turns(search_task(pair, radius_px_))) {
    const Eigen::Vector3d vector = dic::rotation_vector({found.w, found.x, found.y, found.z});
    motion.rot_x_rad = vector.x();
    motion.rot_y_rad = vector.y();
    motion.rot_rad = vector.z();
    motions.push_back(motion);
  }
  return motions;
}

LinkedPose Keyframes::start(const ChainedFrame& frame, KeyframeSlots& slots) {
  if (!frame.circle_ok) return {};
  if (!memory_.keyframes.empty()) {
    if (const auto found = find_again(frame, slots)) return *found;
  }
  // Only what can be followed is worth a beginning.
  return frame.next != nullptr && frame.next->ok ? begin(frame) : LinkedPose{};
}

std::vector<BodyPose> Keyframes::follow(std::span<const ChainedFrame> frames,
                                        KeyframeSlots& slots) {
  const auto linked_to_last = [&](std::size_t i) {
    return i > 0 && frames[i - 1].next != nullptr && frames[i - 1].next->ok;
  };
  std::vector<LinkedPose> poses(frames.size());
  std::size_t i = 0, at_once = frames.size();
  const bool goes_on = !frames.empty() && memory_.last.ok && frames[0].index == memory_.last_index;
  if (goes_on) poses[i++] = memory_.last;
  const BodyPose kept = memory_.last.stated(memory_.radius.sd_px);
  while (i < frames.size()) {
    if (!(linked_to_last(i) && poses[i - 1].ok)) {
      poses[i] = start(frames[i], slots);
      ++i;
      continue;
    }
    std::vector<BodyPose> near;
    for (std::size_t k = i; k < frames.size() && near.size() < at_once && linked_to_last(k); ++k) {
      const BodyPose& before = near.empty() ? poses[i - 1] : near.back();
      near.push_back(moved(before, frames[k - 1].circle, *frames[k - 1].next));
    }
    const double error_px = memory_.radius.error_px;
    const std::vector<LinkedPose> placed =
        place(frames.subspan(i, near.size()), near, {&frames[i - 1], &poses[i - 1]}, slots);
    for (std::size_t k = 0; k < i && memory_.radius.error_px != error_px; ++k) {
      poses[k] = with_radius_error(poses[k], memory_.radius.error_px - error_px);
    }
    for (const LinkedPose& pose : placed) poses[i++] = pose;
    if (placed.size() < near.size()) {
      const LinkedPose reached =
          linked(poses[i - 1], frames[i - 1].circle, *frames[i - 1].next, memory_.radius);
      const bool compressed = frames[i].compressed;
      poses[i] = compressed ? reached : keep(frames[i], reached).pose;
      ++i;
      // A sphere's reach is known by now.
      at_once = sphere_ && !compressed ? frames.size() : kFewAtOnce;
    } else {
      at_once = std::min(2 * at_once, frames.size());
    }
  }
  if (!frames.empty()) {
    memory_.last = poses.back();
    memory_.last_index = frames.back().index;
  }
  std::vector<BodyPose> stated;
  for (const LinkedPose& pose : poses) stated.push_back(pose.stated(memory_.radius.sd_px));
  if (goes_on) stated[0] = kept;
  return stated;
}

}  // namespace impactdic::motion
