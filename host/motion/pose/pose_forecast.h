// Where frames are expected before the poses of those before them are known: the motions from frame
// to frame say it, from the last pose that is known. So they can be registered against keyframes
// that are not all made yet.
#pragma once

#include <vector>

#include "host/motion/pose/keyframes.h"

namespace impactdic::motion {

class PoseForecast {
 public:
  explicit PoseForecast(const KeyframeAim& aim) : aim_(aim) {}

  // Goes on from here.
  void begin(const Keyframes::Memory& settled);
  // Of the next frames, the first of which is the last one of the call before: the poses expected
  // and the keyframes to register against. Nothing where no chain of motions leads to them.
  void plan(Keyframes::Ahead& ahead);

 private:
  KeyframeAim aim_;
  bool known_ = false;  // whether `last_` is
  BodyPose last_;       // of frame last_index_
  std::int64_t last_index_ = -1;
  double reach_rad_ = 0;
  std::vector<Target> targets_;
};

}  // namespace impactdic::motion
