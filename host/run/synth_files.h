// The files that `synth` leaves behind.
#pragma once

#include <impactdic/synth.h>

#include <filesystem>
#include <memory>

#include "host/video/frame_sink.h"

namespace impactdic::run {

// video.* of `frames` frames in `folder`. Throws FileError; InvalidArgument for a format that this
// build or the request's depth does not allow.
std::unique_ptr<video::FrameSink> open_synth_clip(const std::filesystem::path& folder,
                                                  video::SinkFormat format,
                                                  const SynthRequest& request, std::size_t frames);

// truth.csv and, of a ball that is compressed, compression.csv. Throws FileError.
void write_synth_truth(const std::filesystem::path& folder, const SynthTruth& truth,
                       const SynthRequest& request);

}  // namespace impactdic::run
