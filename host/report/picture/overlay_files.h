// overlay/frame_NNNNNN.png and, where the codecs are built, overlay.mp4.
#pragma once

#include <impactdic/track.h>

#include <filesystem>
#include <span>
#include <vector>

#include "host/pipeline/track_clip.h"
#include "host/report/picture/overlay.h"

namespace impactdic::report {

class OverlayFiles {
 public:
  // `earlier`: rows of a run that is resumed. Throws FileError.
  OverlayFiles(std::filesystem::path folder, const OverlayOptions& options, const Roi& roi,
               std::span<const TrackRow> earlier);
  void add(const pipeline::TrackedFrame& frame, int window_px);
  // Now that the impact is known: writes phase, velocity, spin, a scale bar and a reference
  // arrow into every picture and makes the video. Throws FileError.
  void finish(const TrackResult& result) const;

 private:
  std::filesystem::path picture_of(const TrackRow& row) const;

  std::filesystem::path folder_;
  OverlayOptions options_;
  OverlayPainter painter_;
};

}  // namespace impactdic::report
