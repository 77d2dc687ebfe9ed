#include "host/run/open_clip.h"

#include <impactdic/error.h>

#include <cmath>

#include "host/base/parse.h"
#include "host/clip/frame_range.h"
#include "host/clip/roi.h"
#include "host/video/frame_source.h"
#include "host/video/levels/linear_light.h"

namespace impactdic {

std::unique_ptr<FrameSource> open_clip(const std::vector<std::string>& paths,
                                       const OpenOptions& options) {
  auto clip = video::open_video(paths, options);
  const bool is_light = options.gamma == 0 || options.gamma == 1;
  return is_light ? std::move(clip) : video::in_linear_light(std::move(clip), options.gamma);
}

void ClipRequest::validate() const {
  if (paths.empty() && !source) throw InvalidArgument("no video is named");
  if (!(fps >= 0) || !std::isfinite(fps)) {
    throw InvalidArgument("the frame rate must be positive, not " + shortest(fps), "--fps");
  }
  if (!(open.max_megapixels > 0) || !std::isfinite(open.max_megapixels)) {
    throw InvalidArgument("must be positive, not " + shortest(open.max_megapixels),
                          "--max-megapixels");
  }
  if (open.raw) video::check_raw_layout(*open.raw);
}

namespace run {

std::shared_ptr<FrameSource> open_requested(const ClipRequest& request) {
  return request.source ? request.source : open_clip(request.paths, request.open);
}

double resolve_fps(const ClipRequest& request, const ClipInfo& info,
                   const std::string& needed_for) {
  if (request.fps > 0) return request.fps;
  if (info.fps) return *info.fps;
  if (!needed_for.empty()) {
    throw InvalidArgument("the file does not say its frame rate, which " + needed_for + " needs",
                          info.path, "give it with --fps");
  }
  return 0;
}

std::vector<std::string> all_warnings(const ClipRequest& request, const ClipInfo& info,
                                      const ClipAdvice& advice) {
  std::vector<std::string> warnings;
  for (const std::string& warning : info.warnings) {
    const bool answered = request.fps > 0 && warning.find("--fps") != std::string::npos;
    if (!answered) warnings.push_back(warning);
  }
  warnings.insert(warnings.end(), advice.warnings.begin(), advice.warnings.end());
  return warnings;
}

void check_frames(const FrameRange& frames) {
  if (frames.step < 1) throw InvalidArgument("the step must be at least 1", "--frames");
  if (frames.first < 0 || frames.end <= frames.first) {
    throw InvalidArgument("'" + to_text(frames) + "' holds no frame", "--frames");
  }
}

void check_rectangle(const Roi& roi) {
  if (roi.x < 0 || roi.y < 0 || roi.width < 1 || roi.height < 1) {
    throw InvalidArgument("'" + to_text(roi) + "' does not lie in the picture", "--roi");
  }
}

void check_polygon(const std::vector<PointPx>& polygon) {
  if (!polygon.empty() && polygon.size() < 3) {
    throw InvalidArgument("a polygon has at least three corners", "--polygon");
  }
  for (const PointPx& corner : polygon) {
    if (!std::isfinite(corner.x_px) || !std::isfinite(corner.y_px)) {
      throw InvalidArgument("a corner is no finite number", "--polygon");
    }
  }
}

void check_spacing(int spacing_px) {
  if (spacing_px < 0) {
    throw InvalidArgument("the spacing must be 0 or more, not " + std::to_string(spacing_px),
                          "--spacing");
  }
}

void check_compression(int level) {
  if (level < 0 || level > 9) {
    throw InvalidArgument("the level must be 0 to 9, not " + std::to_string(level), "--compress");
  }
}

}  // namespace run
}  // namespace impactdic
