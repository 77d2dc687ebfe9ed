#include "host/run/live/first_frames.h"

#include "host/video/byte_file.h"

namespace impactdic::run {

FirstFrames::FirstFrames(const ClipInfo& stream, const std::vector<video::ArrivedFrame>& frames,
                         double fps)
    : info_(stream) {
  for (const video::ArrivedFrame& arrived : frames) frames_.push_back(arrived.frame);
  info_.frame_count = static_cast<std::int64_t>(frames_.size());
  info_.fps = fps;
}

void FirstFrames::read(std::int64_t index, Frame& frame) {
  video::check_frame_index(info_.path, index, info_.frame_count);
  frame = frames_[static_cast<std::size_t>(index)];
}

}  // namespace impactdic::run
