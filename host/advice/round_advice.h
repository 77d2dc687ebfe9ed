// Whether what turns in a clip is no sphere, but has an outline that is an ellipse and changes.
#pragma once

#include <optional>
#include <string>

#include "host/clip/frame_range.h"
#include "host/clip/roi.h"
#include "host/motion/round/round_body.h"
#include "host/video/frame_source.h"

namespace impactdic::opencl {
class Engine;
}  // namespace impactdic::opencl

namespace impactdic::advice {

// Asked where no pair of frames could be measured as that of a ball. nullopt unless most of the
// frames looked at show one silhouette, it changes from view to view as no ball's outline does, and
// its texture tells the turn of most of the pairs that are tried. A frame that cannot be read shows
// none.
std::optional<motion::RoundBody> find_round_body(opencl::Engine& engine, FrameSource& source,
                                                 const FrameRange& frames, const Roi& roi);

// In one sentence: why it is no sphere, and what that does to its turns.
std::string round_body_in_words(const motion::RoundBody& body);

}  // namespace impactdic::advice
