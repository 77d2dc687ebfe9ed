#include "host/motion/pose/turn_loop.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/dic/sphere/rotation.h"
#include "host/motion/pose/body_motion.h"

namespace impactdic::motion {
namespace {

// Keyframes that follow each other lie 0.1 rad apart: a way of this length is a loop's.
constexpr double kLoop_rad = 1;

const Keyframe* find(std::span<const Keyframe> keyframes, std::int64_t frame) {
  const auto found = std::find_if(keyframes.begin(), keyframes.end(),
                                  [&](const Keyframe& key) { return key.pose.keyframe == frame; });
  return found == keyframes.end() ? nullptr : &*found;
}

double length(const ChainLink& link) {
  return std::hypot(link.turn_rad[0], link.turn_rad[1], link.turn_rad[2]);
}

Eigen::Vector3d vector_of(const std::array<double, 3>& values) {
  return Eigen::Vector3d(values.data());
}

}  // namespace

bool is_far(std::span<const Keyframe> keyframes, std::span<const ChainLink> links,
            std::int64_t from, std::int64_t to) {
  const Keyframe *a = find(keyframes, from), *b = find(keyframes, to);
  if (a == nullptr || b == nullptr || std::abs(a->along_rad - b->along_rad) < kLoop_rad) {
    return false;
  }
  // The shortest way (Bellman 1958). Where links are gone, poses are known without them.
  std::map<std::int64_t, double> away;
  for (const Keyframe& key : keyframes) {
    const bool here = key.pose.keyframe == from || (a->anchored && key.anchored);
    away[key.pose.keyframe] = here ? 0 : std::numeric_limits<double>::infinity();
  }
  for (bool nearer = true; nearer;) {
    nearer = false;
    for (const ChainLink& link : links) {
      double &one = away[link.from], &other = away[link.to];
      const double least = std::min(one, other) + length(link);
      if (!(least < std::max(one, other))) continue;
      (one > other ? one : other) = least;
      nearer = true;
    }
  }
  return away[to] >= kLoop_rad;
}

void unlink(std::int64_t frame, std::vector<Keyframe>& keyframes, std::vector<ChainLink>& links) {
  for (const ChainLink& link : links) {
    if (link.from != frame && link.to != frame) continue;
    const std::int64_t left = link.from == frame ? link.to : link.from;
    for (Keyframe& key : keyframes) {
      if (key.pose.keyframe == left) key.anchored = true;
    }
  }
  std::erase_if(links,
                [&](const ChainLink& link) { return link.from == frame || link.to == frame; });
}

std::optional<TurnLoop> TurnLoop::of(std::span<const Keyframe> keyframes,
                                     std::span<const ChainLink> links, const SphereRadius& radius) {
  const auto estimate = ChainEstimate::of(keyframes, links, radius);
  if (!estimate) return std::nullopt;
  TurnLoop loop;
  loop.before_ = radius;
  loop.now_ = estimate->radius();
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    loop.keys_[keyframes[k].pose.keyframe] = {keyframes[k].pose, estimate->keys()[k]};
  }
  return loop;
}

void TurnLoop::correct(Keyframe& key) const {
  const auto known = keys_.find(key.pose.keyframe);
  if (known == keys_.end()) return;
  key.pose = corrected(key.pose);
  key.off_px = {known->second.now.off.x(), known->second.now.off.y()};
  key.off_sd_px = known->second.now.off_sd_px;
}

LinkedPose TurnLoop::corrected(LinkedPose pose) const {
  const auto known = keys_.find(pose.keyframe);
  if (known == keys_.end() || !is_sphere(pose)) return pose;  // of a frame without a ball
  const LinkedPose& key = known->second.before;
  const Eigen::Matrix3d q = turn_between(key, pose).toRotationMatrix();
  const double px = now_.error_px - before_.error_px;
  const double nearness = now_.nearness_error - before_.nearness_error;
  // What radius and distance did between the keyframe and the pose.
  const Eigen::Vector3d by_radius =
      vector_of(pose.radius_turn_rad) - q * vector_of(key.radius_turn_rad);
  const Eigen::Vector3d by_nearness =
      vector_of(pose.nearness_turn_rad) - q * vector_of(key.nearness_turn_rad);
  const Eigen::Vector3d turn = q * known->second.now.turn - px * by_radius - nearness * by_nearness;
  set_orientation(pose, (dic::quaternion_of(turn) * orientation(pose)).normalized());
  Eigen::Map<Eigen::Vector3d>(pose.radius_turn_rad.data()) = by_radius;
  Eigen::Map<Eigen::Vector3d>(pose.nearness_turn_rad.data()) = by_nearness;
  const Eigen::Matrix3d known_now = known->second.now.turn_covariance;
  Eigen::Map<Eigen::Matrix3d>(pose.turn_noise_rad2.data()) +=
      q * (known_now - Eigen::Matrix3d(key.turn_noise_rad2.data())) * q.transpose();
  pose.x_px -= px * pose.radius_x + nearness * pose.nearness_x;
  pose.y_px -= px * pose.radius_y + nearness * pose.nearness_y;
  return pose;
}

}  // namespace impactdic::motion
