// How keyframes are linked, and what a closed turn makes of them: the part of Keyframes that a
// sphere alone has.
#include <impactdic/units.h>

#include <cmath>

#include "host/motion/pose/keyframes.h"
#include "host/motion/pose/turn_loop.h"

namespace impactdic::motion {
namespace {

// The registration that a pose comes from; nullopt where it was placed by a step.
std::optional<ChainStep> step_of(const Keyframe& key, const BodyPose& pose) {
  if (!std::isfinite(pose.key_rot_x_deg)) return std::nullopt;
  ChainStep step;
  step.circle = key.circle;
  step.motion.dx_px = pose.key_dx_px;
  step.motion.dy_px = pose.key_dy_px;
  step.motion.rot_x_rad = pose.key_rot_x_deg * kRadPerDeg;
  step.motion.rot_y_rad = pose.key_rot_y_deg * kRadPerDeg;
  step.motion.rot_rad = pose.key_rot_deg * kRadPerDeg;
  return step;
}

}  // namespace

std::optional<ChainLink> Keyframes::link_to(std::int64_t next, const LinkedPose& pose,
                                            const ChainedFrame* step,
                                            const LinkedPose* closed) const {
  const Keyframe* from = find(pose.keyframe);
  const Keyframe* to = closed != nullptr ? find(closed->keyframe) : nullptr;
  if (!aim_.sphere() || from == nullptr || (closed != nullptr && to == nullptr)) return {};
  ChainLinkMaker maker(memory_.radius);
  const bool is_key = step != nullptr && step->index == pose.keyframe;
  if (!is_key) {
    const auto first = step_of(*from, pose);
    if (!first) return {};
    maker.first(*first);
  }
  if (step != nullptr) {
    const ChainStep on = {*step->next, step->circle};
    is_key ? maker.first(on) : maker.next(on);
  }
  if (closed != nullptr) {
    const auto back = step_of(*to, *closed);
    if (!back) return {};
    maker.back(*back);
  }
  return maker.link(pose.keyframe, next, memory_.link_covariance);
}

void Keyframes::close_turn(const Before& last, std::span<LinkedPose> earlier,
                           std::vector<LinkedPose>& placed, KeyframePlan& plan) {
  const LinkedPose closed = placed.back();
  const bool goes_on = last.pose->keyframe == closed.keyframe;
  if (goes_on || !is_far(memory_.keyframes, memory_.links, last.pose->keyframe, closed.keyframe)) {
    return;
  }
  const auto link = link_to(closed.keyframe, *last.pose, last.frame, &closed);
  if (!link) return;
  memory_.links.push_back(*link);
  const auto loop = TurnLoop::of(memory_.keyframes, memory_.links, memory_.radius);
  if (!loop) {
    memory_.links.pop_back();
    return;
  }
  for (Keyframe& key : memory_.keyframes) loop->correct(key);
  for (Target& target : plan.targets) {
    if (const Keyframe* key = find(target.key.pose.keyframe)) target.key = *key;
  }
  for (LinkedPose& pose : earlier) pose = loop->corrected(pose);
  for (LinkedPose& pose : placed) pose = loop->corrected(pose);
  memory_.radius = loop->radius();
}

}  // namespace impactdic::motion
