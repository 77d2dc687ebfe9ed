#include "host/motion/pose/pose_forecast.h"

#include "host/motion/pose/body_motion.h"

namespace impactdic::motion {

void PoseForecast::begin(const Keyframes::Memory& settled) {
  known_ = settled.last.ok && !settled.keyframes.empty();
  last_ = settled.last;
  last_index_ = settled.last_index;
  reach_rad_ = settled.reach_rad;
  targets_.clear();
  for (const Keyframe& key : settled.keyframes) targets_.push_back({key, nullptr});
}

void PoseForecast::plan(Keyframes::Ahead& ahead) {
  const std::vector<ChainedFrame>& frames = ahead.frames;
  if (frames.empty() || frames[0].index != last_index_) known_ = false;
  if (!known_) return;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const dic::RigidMotion* motion = frames[i - 1].next;
    if (motion == nullptr || !motion->ok) break;
    ahead.near.push_back(moved(i == 1 ? last_ : ahead.near.back(), frames[i - 1].circle, *motion));
  }
  ahead.plan.targets = targets_;
  aim_.plan(std::span(frames).subspan(1), ahead.near, reach_rad_, ahead.plan);
  known_ = ahead.near.size() + 1 == frames.size();
  if (!known_) return;
  if (!ahead.near.empty()) last_ = ahead.near.back();
  last_index_ = frames.back().index;
  targets_ = ahead.plan.targets;
  for (Target& target : targets_) {
    if (target.frame == nullptr) continue;
    target.key.picture = aim_.picture_of(target.key.circle, *target.frame->frame);
    target.frame = nullptr;
  }
}

}  // namespace impactdic::motion
