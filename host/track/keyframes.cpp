#include "host/track/keyframes.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "host/track/estimators.h"

namespace impactdic {
namespace {

// A residual this many times the keyframe's best one is more than noise: interpolation alone makes
// it vary by a fifth.
constexpr double kMisfit = 1.5;
constexpr double kSamePicture = 0.5;
// Of keyframes whose turns differ by less, the oldest has the shortest chain behind it.
constexpr double kAlike_rad = 0.1;

struct Point {
  double x, y;
};

// (x, y) turned counter-clockwise on the screen, y down.
Point turned(double x, double y, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return {c * x + s * y, -s * x + c * y};
}

// Where the motion to the next frame takes a pose.
BodyPose moved(const BodyPose& pose, const Circle& circle, const RigidMotion& motion) {
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

// Of a frame that was registered against a keyframe; the turn is the one nearest to `expected_rad`.
BodyPose registered(const BodyPose& key, const Circle& circle, const BallMotion& motion,
                    double expected_rad) {
  RigidMotion rigid;
  rigid.dx_px = motion.dx;
  rigid.dy_px = motion.dy;
  rigid.rot_rad = motion.rot_rad;
  rigid.dx_sd_px = motion.dx_sd;
  rigid.dy_sd_px = motion.dy_sd;
  rigid.rot_sd_rad = motion.rot_sd_rad;
  BodyPose pose = moved(key, circle, rigid);
  pose.angle_rad = expected_rad + std::remainder(pose.angle_rad - expected_rad, 2 * kPi);
  return pose;
}

BallOptions affine(BallOptions options) {
  options.affine = true;
  return options;
}

}  // namespace

Keyframes::Keyframes(const Engine& engine, const BallOptions& options, double radius_px)
    : engine_(engine.beside()),
      frames_(*engine_, kKept + kAtOnce),
      radius_px_(radius_px),
      rigid_(*engine_, options),
      affine_(*engine_, affine(options)),
      ring_(*engine_, {}) {}

void Keyframes::restore(Memory memory, const std::function<Frame(std::int64_t)>& read) {
  memory_ = std::move(memory);
  for (const Keyframe& key : memory_.keyframes) frames_.set(key.slot, read(key.pose.keyframe));
}

BodyPose Keyframes::begin(const ChainedFrame& frame) {
  memory_.keyframes.clear();
  BodyPose pose;
  pose.ok = true;
  pose.x_px = frame.circle.cx_px;
  pose.y_px = frame.circle.cy_px;
  pose.angle_rad = pose.x_sd_px = pose.y_sd_px = pose.angle_sd_rad = 0;
  pose.origin = frame.index;
  return keep(frame, pose);
}

BodyPose Keyframes::keep(const ChainedFrame& frame, const BodyPose& pose) {
  Keyframe made;
  made.pose = pose;
  made.pose.keyframe = frame.index;
  made.circle = frame.circle;
  made.last_used = frame.index;
  if (memory_.keyframes.size() == kKept) {
    const auto idle = std::min_element(
        memory_.keyframes.begin(), memory_.keyframes.end(),
        [](const Keyframe& a, const Keyframe& b) { return a.last_used < b.last_used; });
    made.slot = idle->slot;
    memory_.keyframes.erase(idle);
  } else {
    made.slot = static_cast<int>(memory_.keyframes.size());
  }
  memory_.keyframes.push_back(made);
  frames_.set(made.slot, *frame.frame);
  ++made_;
  return made.pose;
}

std::size_t Keyframes::best_for(double angle_rad) const {
  const auto away = [&](const Keyframe& key) {
    return std::abs(std::remainder(key.pose.angle_rad - angle_rad, 2 * kPi));
  };
  double least = kPi;
  for (const Keyframe& key : memory_.keyframes) least = std::min(least, away(key));
  const auto oldest =
      std::find_if(memory_.keyframes.begin(), memory_.keyframes.end(),
                   [&](const Keyframe& key) { return away(key) <= least + kAlike_rad; });
  return static_cast<std::size_t>(oldest - memory_.keyframes.begin());
}

std::vector<BallMotion> Keyframes::measure(BallRegistration& registration, std::size_t first,
                                           std::span<const BodyPose> near,
                                           std::span<const std::size_t> keys) {
  std::vector<BallTask> tasks;
  for (std::size_t i = 0; i < near.size(); ++i) {
    const Keyframe& key = memory_.keyframes[keys[i]];
    const double turn = near[i].angle_rad - key.pose.angle_rad;
    const Point arm =
        turned(key.circle.cx_px - key.pose.x_px, key.circle.cy_px - key.pose.y_px, turn);
    BallTask task{};
    task.first = key.slot;
    task.second = static_cast<idic_int>(kKept + first + i);
    task.cx = static_cast<float>(key.circle.cx_px);
    task.cy = static_cast<float>(key.circle.cy_px);
    task.radius = static_cast<float>(radius_px_ - kRimMarginPx);
    task.guess_dx = static_cast<float>(near[i].x_px + arm.x - key.circle.cx_px);
    task.guess_dy = static_cast<float>(near[i].y_px + arm.y - key.circle.cy_px);
    task.guess_rot_rad = static_cast<float>(std::remainder(turn, 2 * kPi));
    tasks.push_back(task);
  }
  return registration.measure(frames_, tasks);
}

std::vector<Keyframes::Placed> Keyframes::place(std::span<const ChainedFrame> frames,
                                                std::span<const BodyPose> near) {
  std::vector<std::size_t> keys;
  for (const BodyPose& pose : near) keys.push_back(best_for(pose.angle_rad));
  std::vector<const Frame*> pictures;
  for (const ChainedFrame& frame : frames) pictures.push_back(frame.frame);
  frames_.set(kKept, pictures);
  std::vector<BallMotion> motions = measure(rigid_, 0, near, keys);
  std::vector<Placed> placed(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    // What does not fit may be a ball under compression, or look otherwise than it did then.
    const std::size_t newest = memory_.keyframes.size() - 1;
    const std::pair<BallRegistration&, std::size_t> others[] = {
        {affine_, keys[i]}, {rigid_, newest}, {affine_, newest}};
    for (std::size_t k = 0; k < std::size(others) && !fits(motions[i], keys[i]); ++k) {
      if (k > 0 && others[k].second == others[0].second) break;
      keys[i] = others[k].second;
      motions[i] =
          measure(others[k].first, i, near.subspan(i, 1), std::span(keys).subspan(i, 1))[0];
    }
    if (!fits(motions[i], keys[i])) return placed;
    Keyframe& key = memory_.keyframes[keys[i]];
    placed[i].fits = true;
    placed[i].pose = registered(key.pose, key.circle, motions[i], near[i].angle_rad);
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
  return motion.status == static_cast<idic_int>(WindowStatus::ok) &&
         (best == 0 || motion.residual <= kMisfit * best);
}

Keyframes::Placed Keyframes::find_again(const ChainedFrame& frame) {
  const auto key = std::max_element(
      memory_.keyframes.begin(), memory_.keyframes.end(),
      [](const Keyframe& a, const Keyframe& b) { return a.last_used < b.last_used; });
  PairMotion pair;
  pair.first_slot = key->slot;
  pair.second_slot = kKept;
  frames_.set(pair.second_slot, *frame.frame);
  pair.first = key->circle;
  pair.second = frame.circle;
  const RingMotion turn = ring_.measure(frames_, std::vector{ring_task(pair, radius_px_)})[0];
  if (turn.status != WindowStatus::ok) return {};
  RigidMotion motion;
  motion.dx_px = frame.circle.cx_px - key->circle.cx_px;
  motion.dy_px = frame.circle.cy_px - key->circle.cy_px;
  motion.rot_rad = turn.rot_rad;
  return place({&frame, 1}, std::vector{moved(key->pose, key->circle, motion)})[0];
}

BodyPose Keyframes::start(const ChainedFrame& frame) {
  if (!frame.circle_ok) return {};
  if (!memory_.keyframes.empty()) {
    const Placed found = find_again(frame);
    if (found.fits) return found.pose;
  }
  // Only what can be followed is worth a beginning.
  return frame.next != nullptr && frame.next->ok ? begin(frame) : BodyPose{};
}

std::vector<BodyPose> Keyframes::follow(std::span<const ChainedFrame> frames) {
  const auto linked = [&](std::size_t i) {  // to the frame before
    return i > 0 && frames[i - 1].next != nullptr && frames[i - 1].next->ok;
  };
  const auto step = [&](const BodyPose& pose, std::size_t i) {
    return moved(pose, frames[i - 1].circle, *frames[i - 1].next);
  };
  std::vector<BodyPose> poses(frames.size());
  std::size_t i = 0;
  if (!frames.empty() && memory_.last.ok && frames[0].index == memory_.last_index)
    poses[i++] = memory_.last;
  while (i < frames.size()) {
    if (!(linked(i) && poses[i - 1].ok)) {
      poses[i] = start(frames[i]);
      ++i;
      continue;
    }
    std::vector<BodyPose> near;
    for (std::size_t k = i; k < frames.size() && near.size() < kAtOnce && linked(k); ++k) {
      near.push_back(step(near.empty() ? poses[i - 1] : near.back(), k));
    }
    const std::vector<Placed> placed = place(frames.subspan(i, near.size()), near);
    for (std::size_t k = 0; k < placed.size() && placed[k].fits; ++k) poses[i++] = placed[k].pose;
    if (std::any_of(placed.begin(), placed.end(), [](const Placed& p) { return !p.fits; })) {
      poses[i] = keep(frames[i], step(poses[i - 1], i));
      ++i;
    }
  }
  if (!frames.empty()) {
    memory_.last = poses.back();
    memory_.last_index = frames.back().index;
  }
  return poses;
}

}  // namespace impactdic
