// What a clip's bytes are, so that results can be traced to it.
#pragma once

#include <cstdint>
#include <string>

#include "host/video/frame_source.h"

namespace impactdic::video {

struct ClipDigest {
  // Of the file `info.path`. Where that is larger than a piece, of its pieces' digests, one a line,
  // as `split -b 1G --filter=sha256sum FILE | sha256sum` gives it: a single thread would outlast
  // the measurement. Of a sequence, of its files' digests and names, in the order of the frames, as
  // `sha256sum FILES | sha256sum` gives it in their folder.
  std::string sha256;
  std::string header_sha256;  // of `info.header_path`; "" where there is none
};

inline constexpr std::uint64_t kDigestPiece = std::uint64_t{1} << 30;  // bytes

// Reads the whole clip once more, on a few threads of its own. Throws FileError.
ClipDigest digest_of(const ClipInfo& info, std::uint64_t piece_bytes = kDigestPiece);

}  // namespace impactdic::video
