// overlay/frame_NNNNNN.png and, where the codecs are built, overlay.mp4.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "host/pipeline/track_clip.h"
#include "host/report/overlay.h"

namespace impactdic::app {

struct OverlayOptions {
  bool wanted = false;
  double slow_motion = 0;  // how many times slower than life the video plays; 0: 25 frames/s
  double arrow_scale = 5;  // of displacements
};

class OverlayOutput {
 public:
  // `earlier`: rows of a run that is resumed. Throws FileError.
  OverlayOutput(std::filesystem::path folder, const OverlayOptions& options, const Roi& roi,
                std::span<const TrackRow> earlier);
  void add(const pipeline::TrackedFrame& frame, int window_px);
  // Now that the impact is known (`impact` as in summary.json): writes phase, velocity and spin
  // into every picture and makes the video. Throws FileError.
  void finish(const std::vector<TrackRow>& rows, const SiScale& scale,
              const nlohmann::json& impact) const;

 private:
  std::filesystem::path picture_of(const TrackRow& row) const;

  std::filesystem::path folder_;
  OverlayOptions options_;
  report::OverlayPainter painter_;
};

}  // namespace impactdic::app
