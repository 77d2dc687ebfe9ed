#include "host/motion/pose/keyframes.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include "host/dic/sphere/rotation.h"
#include "host/motion/estimators.h"
#include "host/motion/pose/body_motion.h"
#include "host/motion/pose/turn_loop.h"

namespace impactdic::motion {
namespace {

// A residual this many times the keyframe's best one is more than noise: interpolation alone makes
// it vary by a fifth.
constexpr double kMisfit = 1.5;
constexpr double kSamePicture = 0.5;
// Frames that are registered together behind one that did not fit: likely the next does not either.
constexpr std::size_t kFewAtOnce = 4;
// A keyframe is used up to this share of the tilt at which one no longer fitted, and at least to
// this tilt: nearer, it was something else than foreshortening. Wherever all frames fit, the reach
// grows by the last of these.
constexpr double kReach = 0.8, kLeastReach_rad = 0.1, kGrowth = 1.02;

// Whether a motion leads from the frame to the next one.
bool is_linked(const ChainedFrame& frame) { return frame.next != nullptr && frame.next->ok; }

// Where a flat ball is behind a few frames in which it was lost, if it goes on as before: a circle
// that is found behind them may lie elsewhere. `poses`: of the frames before.
std::optional<BodyPose> behind_gap(std::span<const LinkedPose> poses) {
  constexpr std::size_t kLongest = 8;
  std::size_t lost = 0;
  while (lost < poses.size() && !poses[poses.size() - 1 - lost].ok) ++lost;
  if (lost == 0 || lost > kLongest || lost + 2 > poses.size()) return std::nullopt;
  const BodyPose &last = poses[poses.size() - 1 - lost], &before = poses[poses.size() - 2 - lost];
  if (!before.ok || before.origin != last.origin || is_sphere(last)) return std::nullopt;
  const auto steps = static_cast<double>(lost + 1);
  BodyPose near = last;
  near.x_px += steps * (last.x_px - before.x_px);
  near.y_px += steps * (last.y_px - before.y_px);
  near.angle_rad += steps * (last.angle_rad - before.angle_rad);
  return near;
}

}  // namespace

void Keyframes::restore(Memory memory, const std::function<Frame(std::int64_t)>& read) {
  if (memory.radius.px == 0) memory.radius = memory_.radius;  // of an older version
  memory.radius.perspective = memory_.radius.perspective;
  memory.radius.light = memory_.radius.light;
  memory_ = std::move(memory);
  for (Keyframe& key : memory_.keyframes) {
    key.picture = aim_.picture_of(key.circle, read(key.pose.keyframe));
  }
}

LinkedPose Keyframes::begin(const ChainedFrame& frame) {
  memory_.keyframes.clear();
  memory_.links.clear();
  LinkedPose pose;
  pose.ok = true;
  pose.x_px = frame.circle.cx_px;
  pose.y_px = frame.circle.cy_px;
  pose.angle_rad = pose.x_sd_px = pose.y_sd_px = pose.angle_sd_rad = 0;
  if (aim_.sphere()) {
    pose.angle_rad = kNotMeasured;
    pose.tilt_x_sd_rad = pose.tilt_y_sd_rad = 0;
    set_orientation(pose, Eigen::Quaterniond::Identity());
  }
  pose.origin = frame.index;
  return keep(frame, pose).pose;
}

Keyframes::Keyframe Keyframes::keep(const ChainedFrame& frame, const LinkedPose& pose,
                                    const std::optional<ChainLink>& link) {
  Keyframe made;
  made.pose = pose;
  made.pose.keyframe = frame.index;
  made.circle = frame.circle;
  made.shape = frame.shape;
  made.last_used = frame.index;
  made.circle_sd_px = made.off_sd_px = frame.circle_sd_px;
  ++made_;
  if (memory_.keyframes.size() == kKeyframes) {
    const auto idle = std::min_element(
        memory_.keyframes.begin(), memory_.keyframes.end(),
        [](const Keyframe& a, const Keyframe& b) { return a.last_used < b.last_used; });
    const std::int64_t gone = idle->pose.keyframe;
    memory_.keyframes.erase(idle);
    unlink(gone, memory_.keyframes, memory_.links);
  }
  const Keyframe* from = link ? find(link->from) : nullptr;
  made.anchored = from == nullptr;
  if (from != nullptr) {
    made.along_rad = from->along_rad + Eigen::Vector3d(link->turn_rad.data()).norm();
    memory_.links.push_back(*link);
  }
  made.picture = aim_.picture_of(frame.circle, *frame.frame);
  memory_.keyframes.push_back(made);
  return made;
}

const Keyframe* Keyframes::find(std::int64_t frame) const {
  const auto found = std::find_if(memory_.keyframes.begin(), memory_.keyframes.end(),
                                  [&](const Keyframe& key) { return key.pose.keyframe == frame; });
  return found == memory_.keyframes.end() ? nullptr : &*found;
}

Keyframes::Registered Keyframes::measure(std::span<const ChainedFrame> frames,
                                         std::vector<BodyPose> near, const Ahead* ahead,
                                         KeyframeSlots& slots) const {
  Registered made;
  made.near = std::move(near);
  frames = frames.first(made.near.size());
  for (const Keyframe& key : memory_.keyframes) made.plan.targets.push_back({key, nullptr});
  aim_.plan(frames, made.near, memory_.reach_rad, made.plan);
  made.motions = aim_.measure(frames, made.near, made.plan, slots);
  if (ahead == nullptr) return made;
  for (const Target& target : ahead->plan.targets) {
    const auto is_it = [&](const Target& other) { return other.frame == target.frame; };
    const bool among =
        target.frame >= frames.data() && target.frame < frames.data() + frames.size();
    if (among && std::none_of(made.plan.targets.begin(), made.plan.targets.end(), is_it)) {
      made.plan.targets.push_back(target);
    }
  }
  return made;
}

bool Keyframes::is_known(const Ahead& ahead, std::size_t i, std::size_t first) const {
  const Target& target = ahead.plan.targets[ahead.plan.of[i - 1]];
  if (target.frame == nullptr || target.frame < &ahead.frames[first]) {
    return find(target.key.pose.keyframe) != nullptr;
  }
  return target.frame < &ahead.frames[i];
}

Keyframes::Registered Keyframes::registered_ahead(const Ahead& ahead, std::size_t first,
                                                  const std::set<std::size_t>& failed,
                                                  const LinkedPose& before) const {
  Registered taken;
  taken.plan.targets = ahead.plan.targets;
  for (Target& target : taken.plan.targets) {
    const Keyframe* key = find(target.key.pose.keyframe);
    if (key != nullptr) target = {*key, nullptr};
  }
  for (std::size_t i = first; i <= ahead.near.size(); ++i) {
    const std::size_t target = ahead.plan.of[i - 1];
    if (failed.count(target) > 0 || !is_known(ahead, i, first)) break;
    const ChainedFrame& last = ahead.frames[i - 1];
    const BodyPose& from = i == first ? static_cast<const BodyPose&>(before) : taken.near.back();
    taken.near.push_back(moved(from, last.circle, *last.next));
    taken.plan.of.push_back(target);
    taken.motions.push_back(ahead.motions[i - 1]);
  }
  return taken;
}

std::vector<LinkedPose> Keyframes::place(std::span<const ChainedFrame> frames,
                                         Registered& registered, const Before& before,
                                         std::span<LinkedPose> earlier, KeyframeSlots& slots) {
  KeyframePlan& plan = registered.plan;
  const std::size_t count = registered.near.size();
  std::vector<LinkedPose> placed;
  for (std::size_t i = 0; i < count; ++i) {
    const BodyPose& near = registered.near[i];
    Target& target = plan.targets[plan.of[i]];
    if (!is_strained(frames[i], target.key) && fits(registered.motions[i], target.key)) {
      placed.push_back(pose_of(frames[i], near, registered.motions[i], target.key));
    } else if (const auto pose = place_otherwise(frames[i], near, target, slots)) {
      placed.push_back(*pose);
    } else {
      learn_reach(target.key.pose, near);
      break;
    }
    const Before last = i == 0 ? before : Before{&frames[i - 1], &placed[i - 1]};
    if (aim_.sphere() && last.pose != nullptr) close_turn(last, earlier, placed, plan);
    const auto planned = std::find_if(plan.targets.begin(), plan.targets.end(),
                                      [&](const Target& t) { return t.frame == &frames[i]; });
    if (planned != plan.targets.end()) {
      planned->key =
          keep(frames[i], placed.back(), link_to(frames[i].index, placed.back(), nullptr, nullptr));
    }
  }
  if (placed.size() == count) {
    memory_.reach_rad = std::min(memory_.reach_rad * kGrowth, kFarthestTilt_rad);
  }
  return placed;
}

std::optional<LinkedPose> Keyframes::place_otherwise(const ChainedFrame& frame,
                                                     const BodyPose& near, const Target& target,
                                                     KeyframeSlots& slots) {
  const auto tried = [&](Target other, bool affine) -> std::optional<LinkedPose> {
    const BallMotion motion = aim_.measure_one(frame, near, other, affine, slots);
    if (!fits(motion, other.key)) return std::nullopt;
    return pose_of(frame, near, motion, other.key);
  };
  // A sphere's compression has no model.
  std::optional<LinkedPose> pose;
  if (!aim_.sphere()) pose = tried(target, true);
  const Keyframe& newest = memory_.keyframes.back();
  if (pose || newest.pose.keyframe == target.key.pose.keyframe) return pose;
  if (!is_strained(frame, newest)) pose = tried({newest, nullptr}, false);
  if (!pose && !aim_.sphere()) pose = tried({newest, nullptr}, true);
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
  const CropOrigin origin = aim_.crop().about(key.circle);
  std::copy(std::begin(motion.covariance), std::end(motion.covariance),
            memory_.link_covariance.begin());
  return registered({key.pose, key.circle, key.shape, key.off_px, key.off_sd_px}, motion,
                    {frame.origin.x - origin.x, frame.origin.y - origin.y}, near.angle_rad,
                    memory_.radius);
}

void Keyframes::learn_reach(const BodyPose& key, const BodyPose& near) {
  if (!aim_.sphere()) return;
  memory_.reach_rad =
      std::min(memory_.reach_rad, std::max(kReach * tilt_between(key, near), kLeastReach_rad));
}

bool Keyframes::is_strained(const ChainedFrame& frame, const Keyframe& key) const {
  return !aim_.sphere() && (frame.shape.is_compressed() || key.shape.is_compressed());
}

bool Keyframes::fits(const BallMotion& motion, const Keyframe& key) const {
  if (aim_.sphere() && !(motion.used > kLeastSeen)) return false;
  return motion.status == static_cast<idic_int>(WindowStatus::kOk) &&
         (key.residual == 0 || motion.residual <= kMisfit * key.residual);
}

std::optional<LinkedPose> Keyframes::find_near(const ChainedFrame& frame, const BodyPose& near,
                                               KeyframeSlots& slots) {
  Registered registered = measure({&frame, 1}, {near}, nullptr, slots);
  const std::vector<LinkedPose> found = place({&frame, 1}, registered, {}, {}, slots);
  return found.empty() ? std::nullopt : std::optional(found[0]);
}

std::optional<LinkedPose> Keyframes::find_again(const ChainedFrame& frame,
                                                const std::optional<BodyPose>& near,
                                                KeyframeSlots& slots) {
  if (near) {
    if (const auto found = find_near(frame, *near, slots)) return found;
  }
  const auto key = std::max_element(
      memory_.keyframes.begin(), memory_.keyframes.end(),
      [](const Keyframe& a, const Keyframe& b) { return a.last_used < b.last_used; });
  for (const dic::RigidMotion& motion : sought(*key, frame, slots)) {
    const auto found = find_near(frame, moved(key->pose, key->circle, motion), slots);
    if (found) return found;
  }
  return std::nullopt;
}

std::vector<dic::RigidMotion> Keyframes::sought(const Keyframe& key, const ChainedFrame& frame,
                                                KeyframeSlots& slots) {
  PairMotion pair;
  pair.first_slot = aim_.hold(key, slots);
  pair.second_slot = frame.slot;
  pair.first = key.circle;
  pair.second = frame.circle;
  into_crops(pair, aim_.crop().about(key.circle), frame.origin);
  dic::RigidMotion motion;
  motion.dx_px = frame.circle.cx_px - key.circle.cx_px;
  motion.dy_px = frame.circle.cy_px - key.circle.cy_px;
  if (!aim_.sphere()) {
    const dic::RingMotion turn = slots.turn(ring_task(pair, aim_.radius_px()));
    if (turn.status != WindowStatus::kOk) return {};
    motion.rot_rad = turn.rot_rad;
    return {motion};
  }
  std::vector<dic::RigidMotion> motions;
  for (const dic::SphereTurn& found : slots.turns(search_task(pair, aim_.radius_px()))) {
    const Eigen::Vector3d vector = dic::rotation_vector({found.w, found.x, found.y, found.z});
    motion.rot_x_rad = vector.x();
    motion.rot_y_rad = vector.y();
    motion.rot_rad = vector.z();
    motions.push_back(motion);
  }
  return motions;
}

LinkedPose Keyframes::start(const ChainedFrame& frame, const std::optional<BodyPose>& near,
                            KeyframeSlots& slots) {
  if (!frame.circle_ok) return {};
  if (!memory_.keyframes.empty()) {
    if (const auto found = find_again(frame, near, slots)) return *found;
  }
  // Only what can be followed is worth a beginning.
  return is_linked(frame) ? begin(frame) : LinkedPose{};
}

std::vector<BodyPose> Keyframes::expected(std::span<const ChainedFrame> frames, std::size_t first,
                                          std::size_t most, const LinkedPose& before,
                                          const Ahead* ahead,
                                          const std::set<std::size_t>& failed) const {
  const auto is_registered = [&](std::size_t k) {
    return ahead != nullptr && k <= ahead->near.size() &&
           failed.count(ahead->plan.of[k - 1]) == 0 && is_known(*ahead, k, first);
  };
  std::vector<BodyPose> near;
  for (std::size_t k = first; k < frames.size() && near.size() < most; ++k) {
    const ChainedFrame& last = frames[k - 1];
    if (!is_linked(last) || (k > first && is_registered(k))) break;
    const BodyPose& from = near.empty() ? static_cast<const BodyPose&>(before) : near.back();
    near.push_back(moved(from, last.circle, *last.next));
  }
  return near;
}

std::vector<BodyPose> Keyframes::follow(std::span<const ChainedFrame> frames, const Ahead* ahead,
                                        KeyframeSlots& slots) {
  std::vector<LinkedPose> poses(frames.size());
  std::size_t i = 0, at_once = frames.size();
  const bool goes_on = !frames.empty() && memory_.last.ok && frames[0].index == memory_.last_index;
  if (goes_on) poses[i++] = memory_.last;
  const BodyPose kept = memory_.last.stated(memory_.radius);
  std::set<std::size_t> failed;  // targets of `ahead`
  while (i < frames.size()) {
    if (i == 0 || !is_linked(frames[i - 1]) || !poses[i - 1].ok) {
      poses[i] = start(frames[i], behind_gap(std::span(poses).first(i)), slots);
      ++i;
      continue;
    }
    Registered registered;
    if (ahead != nullptr) registered = registered_ahead(*ahead, i, failed, poses[i - 1]);
    const bool was_ahead = !registered.near.empty();
    if (!was_ahead) {
      registered = measure(frames.subspan(i),
                           expected(frames, i, at_once, poses[i - 1], ahead, failed), ahead, slots);
    }
    const std::vector<LinkedPose> placed =
        place(frames.subspan(i), registered, {&frames[i - 1], &poses[i - 1]},
              std::span(poses).first(i), slots);
    for (const LinkedPose& pose : placed) poses[i++] = pose;
    if (placed.size() == registered.near.size()) {
      at_once = std::min(2 * at_once, frames.size());
      continue;
    }
    if (was_ahead) failed.insert(registered.plan.of[placed.size()]);
    const LinkedPose reached =
        linked(poses[i - 1], frames[i - 1].circle, *frames[i - 1].next, memory_.radius);
    const bool compressed = frames[i].shape.is_compressed();
    const auto link = link_to(frames[i].index, poses[i - 1], &frames[i - 1], nullptr);
    poses[i] = compressed ? reached : keep(frames[i], reached, link).pose;
    ++i;
    // A sphere's reach is known by now.
    at_once = aim_.sphere() && !compressed ? frames.size() : kFewAtOnce;
  }
  if (!frames.empty()) {
    memory_.last = poses.back();
    memory_.last_index = frames.back().index;
  }
  std::vector<BodyPose> stated;
  for (const LinkedPose& pose : poses) stated.push_back(pose.stated(memory_.radius));
  if (goes_on) stated[0] = kept;
  return stated;
}

}  // namespace impactdic::motion
