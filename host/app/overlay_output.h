// overlay/frame_NNNNNN.png and, where the codecs are built, overlay.mp4.
#pragma once

#include <filesystem>
#include <memory>

#include "host/report/overlay.h"
#include "host/track/track_clip.h"

namespace impactdic::app {

class OverlayOutput {
 public:
  explicit OverlayOutput(std::filesystem::path folder);
  ~OverlayOutput();
  void add(const TrackedFrame& frame, const Roi& roi, int window_px);
  void finish();

 private:
  struct Video;
  std::filesystem::path folder_;
  OverlayPainter painter_;
  std::unique_ptr<Video> video_;
};

}  // namespace impactdic::app
