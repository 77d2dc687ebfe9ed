// The first frames of a stream as a clip, for the look before a run.
#pragma once

#include <impactdic/clip.h>

#include <vector>

#include "host/video/live/frame_queue.h"

namespace impactdic::run {

// Copies the frames.
class FirstFrames : public FrameSource {
 public:
  FirstFrames(const ClipInfo& stream, const std::vector<video::ArrivedFrame>& frames, double fps);
  const ClipInfo& info() const override { return info_; }
  void read(std::int64_t index, Frame& frame) override;

 private:
  ClipInfo info_;
  std::vector<Frame> frames_;
};

}  // namespace impactdic::run
