// A few frames of a clip kept as pictures beside its results: a report shows them (Fig. 2.10)
// without the clip.
#pragma once

#include <impactdic/clip.h>
#include <impactdic/track.h>

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "host/clip/track_rows.h"

namespace impactdic::report {

// Writes key_frames/frame_NNNNNN.png into `folder`: the last frame before the contact, the one
// nearest to the maximum compression and the first one after the contact; without an impact the
// first, middle and last frame with a ball. All are cut to one
// box around the ball, and stretched to 8 bits by one factor. Returns their list for summary.json:
// moment, frame, picture (path in `folder`), x_px, y_px (of the picture's first pixel). A frame
// that cannot be read is left out. Throws FileError where a picture cannot be written.
nlohmann::json write_key_frames(FrameSource& source, const TrackRows& rows,
                                const ImpactFigures& impact, const std::filesystem::path& folder);

}  // namespace impactdic::report
