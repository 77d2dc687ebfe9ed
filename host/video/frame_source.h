// Video files as sequences of grey frames. One interface, one reader per format behind it.
#pragma once

#include <impactdic/clip.h>

#include <memory>
#include <string>
#include <vector>

namespace impactdic::video {

// Parses "WIDTHxHEIGHTxBITS", and the other way. Throws InvalidArgument.
RawLayout parse_raw_layout(const std::string& text);
std::string to_text(const RawLayout& layout);
// Throws InvalidArgument for a size or depth that no raw file has.
void check_raw_layout(const RawLayout& layout);

// Opens a clip: a .cine, .mraw/.cih/.cihx, .tif/.tiff (multi-page), container, a folder or a
// quoted glob of pictures (natural numeric order), raw bytes; or several picture files that form
// a sequence. The format is told by the contents first, the extension second.
// Throws FileError (not there, not readable), FormatError (damaged), InvalidArgument.
std::unique_ptr<FrameSource> open_video(const std::vector<std::string>& inputs,
                                        const OpenOptions& options = {});

}  // namespace impactdic::video
