// How keyframes hang together by links, and what is learnt where a ball that has come round shows a
// keyframe's face again.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "host/motion/pose/chain_estimate.h"
#include "host/motion/pose/keyframe_plan.h"

namespace impactdic::motion {

// Keyframes by their frames. Whether the links lead from one to the other by a long way only.
bool is_far(std::span<const Keyframe> keyframes, std::span<const ChainLink> links,
            std::int64_t from, std::int64_t to);

// Takes the links of a keyframe that goes away. Those that it was linked with keep their poses as
// they are known then.
void unlink(std::int64_t frame, std::vector<Keyframe>& keyframes, std::vector<ChainLink>& links);

// A closed turn: keyframes, and poses that lean on them, by one estimate over all links.
class TurnLoop {
 public:
  // The last link closes it. Empty where it is not likely to.
  static std::optional<TurnLoop> of(std::span<const Keyframe> keyframes,
                                    std::span<const ChainLink> links, const SphereRadius& radius);

  // Radius and distance as they are thought to be now.
  const SphereRadius& radius() const { return now_; }
  void correct(Keyframe& key) const;
  // A pose of before, of a frame that leans on one of the keyframes, or of one of these.
  LinkedPose corrected(LinkedPose pose) const;

 private:
  struct Known {
    LinkedPose before;
    ChainEstimate::Key now;
  };
  SphereRadius before_, now_;
  std::map<std::int64_t, Known> keys_;  // by frame
};

}  // namespace impactdic::motion
