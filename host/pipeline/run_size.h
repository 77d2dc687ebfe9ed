// How much of a run is done at once.
#pragma once

#include <span>

#include "host/pipeline/track_clip.h"

namespace impactdic::pipeline {

// Frames that are handed on together, of so many bits a pixel.
int frames_in_batch(const TrackOptions& options, int bits);

// Threads of oneTBB, for what is done on the host. The workers of a GPU have threads of their own:
// with as many of oneTBB as there are cores beside them, all of them take turns.
int threads_beside(const TrackOptions& options, std::span<opencl::Engine* const> engines);

}  // namespace impactdic::pipeline
