// Tells a file's format from its first bytes.
#pragma once

#include <string>

namespace impactdic::video {

enum class FileKind { kUnknown, kCine, kMraw, kCih, kTiff, kSeq, kContainer, kPicture };

// The contents decide; the extension only where they say nothing (.mraw, a cine without mark).
// Throws FileError (absent, unreadable) and FormatError (empty file).
FileKind tell_file_kind(const std::string& path);
// True for the extensions of pictures: .tif .tiff .png .bmp .jpg .jpeg .pgm, in any case.
bool has_picture_extension(const std::string& path);
std::string lower_case(std::string text);
// The extension in small letters, with its dot.
std::string lower_extension(const std::string& path);

}  // namespace impactdic::video
