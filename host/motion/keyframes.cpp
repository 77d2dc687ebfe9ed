#include "host/motion/keyframes.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "host/clip/roi.h"
#include "host/dic/sphere/rotation.h"
#include "host/motion/estimators.h"

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

struct Point {
  double x, y;
};

bool is_sphere(const BodyPose& pose) {
  return std::isfinite(pose.qw) && std::isnan(pose.angle_rad);
}

Eigen::Quaterniond orientation(const BodyPose& pose) {
  return Eigen::Quaterniond(pose.qw, pose.qx, pose.qy, pose.qz);
}

void set_orientation(BodyPose& pose, const Eigen::Quaterniond& turn) {
  pose.qw = turn.w();
  pose.qx = turn.x();
  pose.qy = turn.y();
  pose.qz = turn.z();
}

// From `from` to `to`, in the camera's axes.
Eigen::Quaterniond turn_between(const BodyPose& from, const BodyPose& to) {
  return orientation(to) * orientation(from).conjugate();
}

// (x, y) px at the depth of the centre, turned in space; y down.
Point turned(double x, double y, const Eigen::Quaterniond& turn) {
  const Eigen::Vector3d to = dic::in_picture(turn) * Eigen::Vector3d(x, y, 0);
  return {to.x(), to.y()};
}

// (x, y) turned counter-clockwise on the screen, y down.
Point turned(double x, double y, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return {c * x + s * y, -s * x + c * y};
}

// Where the motion to the next frame takes a sphere's pose.
BodyPose moved_sphere(const BodyPose& pose, const Circle& circle, const dic::RigidMotion& motion) {
  const Eigen::Quaterniond turn =
      dic::quaternion_of({motion.rot_x_rad, motion.rot_y_rad, motion.rot_rad});
  BodyPose next = pose;
  const Point arm = turned(pose.x_px - circle.cx_px, pose.y_px - circle.cy_px, turn);
  next.x_px = circle.cx_px + motion.dx_px + arm.x;
  next.y_px = circle.cy_px + motion.dy_px + arm.y;
  set_orientation(next, (turn * orientation(pose)).normalized());
  next.x_sd_px = std::hypot(pose.x_sd_px, motion.dx_sd_px);
  next.y_sd_px = std::hypot(pose.y_sd_px, motion.dy_sd_px);
  next.tilt_x_sd_rad = std::hypot(pose.tilt_x_sd_rad, motion.rot_x_sd_rad);
  next.tilt_y_sd_rad = std::hypot(pose.tilt_y_sd_rad, motion.rot_y_sd_rad);
  next.angle_sd_rad = std::hypot(pose.angle_sd_rad, motion.rot_sd_rad);
  return next;
}

// Where the motion to the next frame takes a pose.
BodyPose moved(const BodyPose& pose, const Circle& circle, const dic::RigidMotion& motion) {
  if (is_sphere(pose)) return moved_sphere(pose, circle, motion);
  BodyPose next = pose;
  const Point arm = turned(pose.x_px - circle.cx_px, pose.y_px - circle.cy_px, motion.rot_rad);
  next.x_px = circle.cx_px + motion.dx_px + arm.x;
  next.y_px = circle.cy_px + motion.dy_px + arm.y;
  next.angle_rad = pose.angle_rad + motion.rot_rad;
  next.x_sd_px = std::hypot(pose.x_sd_px, motion.dx_sd_px, arm.y * motion.rot_sd_rad);
  next.y_sd_px = std::hypot(pose.y_sd_px, motion.dy_sd_px, arm.x * motion.rot_sd_rad);
  next.angle_sd_rad = std::hypot(pose.angle_sd_rad, motion.rot_sd_rad);
  return next;
}

// Of a frame that was registered against a keyframe, its part's corner (u, v) from that one's; the
// turn is the one nearest to `expected_rad`.
BodyPose registered(const BodyPose& key, const Circle& circle, const BallMotion& motion, int u,
                    int v, double expected_rad, double radius_sd_px) {
  dic::RigidMotion rigid =
      is_sphere(key) ? sphere_motion(motion, radius_sd_px) : dic::RigidMotion{};
  rigid.dx_px = motion.dx + u;
  rigid.dy_px = motion.dy + v;
  if (is_sphere(key)) return moved_sphere(key, circle, rigid);
  rigid.rot_rad = motion.rot_rad;
  rigid.dx_sd_px = motion.dx_sd;
  rigid.dy_sd_px = motion.dy_sd;
  rigid.rot_sd_rad = motion.rot_sd_rad;
  BodyPose pose = moved(key, circle, rigid);
  pose.angle_rad = expected_rad + std::remainder(pose.angle_rad - expected_rad, 2 * kPi);
  return pose;
}

dic::BallOptions affine(dic::BallOptions options) {
  options.model = dic::BallModel::kAffine;
  return options;
}

}  // namespace

KeyframeSlots::KeyframeSlots(opencl::Engine& engine, dic::DeviceFrames& frames, int first_slot,
                             const dic::BallOptions& options)
    : frames_(frames),
      first_slot_(first_slot),
      rigid_(engine, options),
      affine_(engine, affine(options)),
      ring_(engine, {}),
      search_(engine) {
  held_.fill(-1);
}

void KeyframeSlots::hold(int place, std::int64_t index, const Frame& picture) {
  std::int64_t& held = held_.at(static_cast<std::size_t>(place));
  if (held == index) return;
  frames_.set(slot(place), picture);
  held = index;
}

std::vector<BallMotion> KeyframeSlots::measure(std::span<const BallTask> tasks, bool affine) {
  return (affine ? affine_ : rigid_).measure(frames_, tasks);
}

dic::RingMotion KeyframeSlots::turn(const RingTask& task) {
  return ring_.measure(frames_, std::span(&task, 1))[0];
}

std::vector<dic::SphereTurn> KeyframeSlots::turns(const SphereSearchTask& task) {
  return search_.find(frames_, task);
}

void Keyframes::restore(Memory memory, const std::function<Frame(std::int64_t)>& read) {
  memory_ = std::move(memory);
  for (const Keyframe& key : memory_.keyframes) keep_picture(key, read(key.pose.keyframe));
}

void Keyframes::keep_picture(const Keyframe& key, const Frame& frame) {
  const CropOrigin origin = crop_.about(key.circle);
  crop(frame, {origin.x, origin.y, crop_.width(), crop_.height()},
       pictures_.at(static_cast<std::size_t>(key.slot)));
}

int Keyframes::hold(const Keyframe& key, KeyframeSlots& slots) const {
  slots.hold(key.slot, key.pose.keyframe, pictures_.at(static_cast<std::size_t>(key.slot)));
  return slots.slot(key.slot);
}

BodyPose Keyframes::begin(const ChainedFrame& frame) {
  memory_.keyframes.clear();
  BodyPose pose;
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
  return keep(frame, pose);
}

BodyPose Keyframes::keep(const ChainedFrame& frame, const BodyPose& pose) {
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
  return made.pose;
}

std::size_t Keyframes::best_for(const BodyPose& pose) const {
  const auto away = [&](const Keyframe& key) {
    if (sphere_) return orientation(key.pose).angularDistance(orientation(pose));
    return std::abs(std::remainder(key.pose.angle_rad - pose.angle_rad, 2 * kPi));
  };
  double least = kPi;
  for (const Keyframe& key : memory_.keyframes) least = std::min(least, away(key));
  const auto oldest =
      std::find_if(memory_.keyframes.begin(), memory_.keyframes.end(),
                   [&](const Keyframe& key) { return away(key) <= least + kAlike_rad; });
  return static_cast<std::size_t>(oldest - memory_.keyframes.begin());
}

std::vector<BallMotion> Keyframes::measure(std::span<const ChainedFrame> frames,
                                           std::span<const BodyPose> near,
                                           std::span<const std::size_t> keys, bool affine,
                                           KeyframeSlots& slots) {
  std::vector<BallTask> tasks;
  for (std::size_t i = 0; i < near.size(); ++i) {
    const Keyframe& key = memory_.keyframes[keys[i]];
    const CropOrigin origin = crop_.about(key.circle);
    const int u = frames[i].origin.x - origin.x, v = frames[i].origin.y - origin.y;
    const double arm_x = key.circle.cx_px - key.pose.x_px;
    const double arm_y = key.circle.cy_px - key.pose.y_px;
    if (sphere_) {
      const Eigen::Quaterniond turn = turn_between(key.pose, near[i]);
      const Point arm = turned(arm_x, arm_y, turn);
      const Eigen::Vector3d vector = dic::rotation_vector(turn);
      dic::RigidMotion start;
      start.dx_px = near[i].x_px + arm.x - key.circle.cx_px - u;
      start.dy_px = near[i].y_px + arm.y - key.circle.cy_px - v;
      start.rot_x_rad = vector.x();
      start.rot_y_rad = vector.y();
      start.rot_rad = vector.z();
      const Circle cut{key.circle.cx_px - origin.x, key.circle.cy_px - origin.y, key.circle.r_px};
      BallTask task = sphere_task(cut, radius_px_, start);
      task.first = hold(key, slots);
      task.second = frames[i].slot;
      tasks.push_back(task);
      continue;
    }
    const double turn = near[i].angle_rad - key.pose.angle_rad;
    const Point arm = turned(arm_x, arm_y, turn);
    BallTask task{};
    task.first = hold(key, slots);
    task.second = frames[i].slot;
    task.cx = static_cast<float>(key.circle.cx_px - origin.x);
    task.cy = static_cast<float>(key.circle.cy_px - origin.y);
    task.radius = static_cast<float>(radius_px_ - dic::kRimMarginPx);
    task.guess_dx = static_cast<float>(near[i].x_px + arm.x - key.circle.cx_px - u);
    task.guess_dy = static_cast<float>(near[i].y_px + arm.y - key.circle.cy_px - v);
    task.guess_rot_rad = static_cast<float>(std::remainder(turn, 2 * kPi));
    tasks.push_back(task);
  }
  return slots.measure(tasks, affine);
}

std::vector<Keyframes::Placed> Keyframes::place(std::span<const ChainedFrame> frames,
                                                std::span<const BodyPose> near,
                                                KeyframeSlots& slots) {
  std::vector<std::size_t> keys;
  for (const BodyPose& pose : near) keys.push_back(best_for(pose));
  std::vector<BallMotion> motions = measure(frames, near, keys, false, slots);
  std::vector<Placed> placed(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    // What does not fit may be a ball under compression, or look otherwise than it did then.
    const std::size_t newest = memory_.keyframes.size() - 1;
    const std::pair<bool, std::size_t> others[] = {
        {true, keys[i]}, {false, newest}, {true, newest}};
    for (std::size_t k = 0; k < std::size(others) && !fits(motions[i], keys[i]); ++k) {
      if (k > 0 && others[k].second == others[0].second) break;
      if (sphere_ && others[k].first) continue;  // its compression has no model
      keys[i] = others[k].second;
      motions[i] = measure(frames.subspan(i, 1), near.subspan(i, 1), std::span(keys).subspan(i, 1),
                           others[k].first, slots)[0];
    }
    if (!fits(motions[i], keys[i])) return placed;
    Keyframe& key = memory_.keyframes[keys[i]];
    placed[i].fits = true;
    const CropOrigin origin = crop_.about(key.circle);
    placed[i].pose = registered(key.pose, key.circle, motions[i], frames[i].origin.x - origin.x,
                                frames[i].origin.y - origin.y, near[i].angle_rad, radius_sd_px_);
    const double residual = motions[i].residual;
    // A residual far below the best is no better fit but the same picture once more: a clip that
    // repeats itself, a camera that stored a frame twice.
    const bool lower = residual < key.residual && residual > kSamePicture * key.residual;
    if (key.residual == 0 || lower) key.residual = residual;
    key.last_used = frames[i].index;
  }
  return placed;
}

bool Keyframes::fits(const BallMotion& motion, std::size_t key) const {
  const double best = memory_.keyframes[key].residual;
  if (sphere_ && !(motion.used > kLeastSeen)) return false;
  return motion.status == static_cast<idic_int>(WindowStatus::kOk) &&
         (best == 0 || motion.residual <= kMisfit * best);
}

Keyframes::Placed Keyframes::find_again(const ChainedFrame& frame, KeyframeSlots& slots) {
  const auto key = std::max_element(
      memory_.keyframes.begin(), memory_.keyframes.end(),
      [](const Keyframe& a, const Keyframe& b) { return a.last_used < b.last_used; });
  for (const dic::RigidMotion& motion : sought(*key, frame, slots)) {
    const Placed found =
        place({&frame, 1}, std::vector{moved(key->pose, key->circle, motion)}, slots)[0];
    if (found.fits) return found;
  }
  return {};
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

BodyPose Keyframes::start(const ChainedFrame& frame, KeyframeSlots& slots) {
  if (!frame.circle_ok) return {};
  if (!memory_.keyframes.empty()) {
    const Placed found = find_again(frame, slots);
    if (found.fits) return found.pose;
  }
  // Only what can be followed is worth a beginning.
  return frame.next != nullptr && frame.next->ok ? begin(frame) : BodyPose{};
}

std::vector<BodyPose> Keyframes::follow(std::span<const ChainedFrame> frames,
                                        KeyframeSlots& slots) {
  const auto linked = [&](std::size_t i) {  // to the frame before
    return i > 0 && frames[i - 1].next != nullptr && frames[i - 1].next->ok;
  };
  const auto step = [&](const BodyPose& pose, std::size_t i) {
    return moved(pose, frames[i - 1].circle, *frames[i - 1].next);
  };
  std::vector<BodyPose> poses(frames.size());
  std::size_t i = 0, at_once = frames.size();
  if (!frames.empty() && memory_.last.ok && frames[0].index == memory_.last_index)
    poses[i++] = memory_.last;
  while (i < frames.size()) {
    if (!(linked(i) && poses[i - 1].ok)) {
      poses[i] = start(frames[i], slots);
      ++i;
      continue;
    }
    std::vector<BodyPose> near;
    for (std::size_t k = i; k < frames.size() && near.size() < at_once && linked(k); ++k) {
      near.push_back(step(near.empty() ? poses[i - 1] : near.back(), k));
    }
    const std::vector<Placed> placed = place(frames.subspan(i, near.size()), near, slots);
    for (std::size_t k = 0; k < placed.size() && placed[k].fits; ++k) poses[i++] = placed[k].pose;
    if (std::any_of(placed.begin(), placed.end(), [](const Placed& p) { return !p.fits; })) {
      const BodyPose reached = step(poses[i - 1], i);
      poses[i] = frames[i].compressed ? reached : keep(frames[i], reached);
      ++i;
      at_once = kFewAtOnce;
    } else {
      at_once = std::min(2 * at_once, frames.size());
    }
  }
  if (!frames.empty()) {
    memory_.last = poses.back();
    memory_.last_index = frames.back().index;
  }
  return poses;
}

}  // namespace impactdic::motion
