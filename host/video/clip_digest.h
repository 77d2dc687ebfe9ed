// What a clip's bytes are, so that results can be traced to it.
#pragma once

#include <string>

#include "host/video/frame_source.h"

namespace impactdic {

struct ClipDigest {
  // Of the file `info.path`; of a sequence that of its files' digests and names, in the order of
  // the frames, as `sha256sum FILES | sha256sum` gives it in their folder.
  std::string sha256;
  std::string header_sha256;  // of `info.header_path`; "" where there is none
};

// Reads the whole clip once more. Throws FileError.
ClipDigest digest_of(const VideoInfo& info);

}  // namespace impactdic
