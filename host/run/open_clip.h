// The clip that a request names, and what of the request goes by it.
#pragma once

#include <impactdic/advice.h>
#include <impactdic/clip.h>

#include <memory>
#include <string>
#include <vector>

namespace impactdic::run {

// Opens it with every reader that this build has, unless the request brings its source.
std::shared_ptr<FrameSource> open_requested(const ClipRequest& request);

// The rate of the stored frames: the request's, else the clip's; throws InvalidArgument where
// neither is known and `needed_for` is not empty, else gives 0.
double resolve_fps(const ClipRequest& request, const ClipInfo& info, const std::string& needed_for);

// What the clip's header makes doubtful (its frame rate not where the request gives one), and what
// the look found.
std::vector<std::string> all_warnings(const ClipRequest& request, const ClipInfo& info,
                                      const ClipAdvice& advice);

// Throw InvalidArgument for what no clip has, whatever it is.
void check_frames(const FrameRange& frames);
void check_rectangle(const Roi& roi);
void check_polygon(const std::vector<PointPx>& polygon);  // an empty one is none
void check_spacing(int spacing_px);
void check_compression(int level);

}  // namespace impactdic::run
