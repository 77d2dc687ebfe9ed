// Frames that show the picture before them once more, or a part of it: a recorder puts them in for
// those it has lost, a converter to reach another frame rate. Nothing of their own time is in them.
#pragma once

#include <impactdic/image.h>

#include "host/pipeline/track_batch.h"

namespace impactdic::pipeline {

// Whether all pixels are the same. No two exposures of a camera are.
bool is_same_picture(const Frame& a, const Frame& b);

// Marks in TrackBatch::repeats the torn frames, too: a part of the ball in them is the picture
// before it pixel by pixel, as where a recorder began to read a frame before it was whole. Not for
// film that a coder has made: it copies what moves little. The batch's circles must be known.
void note_torn(TrackBatch& batch);

// Marks the rows of repeated frames and those that lead to them, whose motions are filled in, and
// empties what was not measured. A frame is repeated whose picture is the same while the ball moves
// before and after (of one at rest a coder makes the same pictures); or, where a coder has changed
// the picture, in which the ball neither moves nor turns between two plain steps, as no ball does
// but where it turns back.
// `before`: the row before the batch's first, or nullptr; `first`: that one was found to be
// repeated, by the batch before. Leaves in TrackBatch::repeats which were.
void leave_out_repeats(TrackBatch& batch, const TrackRow* before, bool first);

}  // namespace impactdic::pipeline
