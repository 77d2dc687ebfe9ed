#include "host/video/file_kind.h"

#include <impactdic/error.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <string_view>

#include "host/video/byte_file.h"

namespace impactdic::video {

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string lower_extension(const std::string& path) {
  return lower_case(std::filesystem::path(path).extension().string());
}

bool has_picture_extension(const std::string& path) {
  constexpr std::array<std::string_view, 7> kPictures = {".tif", ".tiff", ".png", ".bmp",
                                                         ".jpg", ".jpeg", ".pgm"};
  return std::find(kPictures.begin(), kPictures.end(), lower_extension(path)) != kPictures.end();
}

FileKind tell_file_kind(const std::string& path) {
  using namespace std::string_view_literals;
  const ByteFile file(path);
  if (file.size() == 0) throw FormatError(path, 0, "the file is empty");
  const auto bytes = file.head(264);
  const std::string_view head(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto at = [head](std::size_t offset, std::string_view text) {
    return head.size() >= offset + text.size() && head.substr(offset, text.size()) == text;
  };
  const std::string extension = lower_extension(path);
  // The mark alone is two letters; the header's size follows it.
  if (at(0, "CI\x2c\0"sv)) return FileKind::kCine;
  if (at(0, "II\x2a\0"sv) || at(0, "MM\0\x2a"sv) || at(0, "II\x2b\0"sv) || at(0, "MM\0\x2b"sv)) {
    return FileKind::kTiff;
  }
  if (at(0, "\xed\xfe\0\0N\0o\0r\0p\0i\0x\0"sv)) return FileKind::kSeq;
  if (at(256, "CIHX") || at(0, "#Camera Information Header")) return FileKind::kCih;
  if ((at(0, "RIFF") && at(8, "AVI ")) || at(4, "ftyp") || at(0, "\x1a\x45\xdf\xa3")) {
    return FileKind::kContainer;
  }
  if (at(0, "\x89PNG") || at(0, "\xff\xd8\xff") || at(0, "P5") ||
      (at(0, "BM") && extension == ".bmp")) {
    return FileKind::kPicture;
  }
  // Bare pixels may begin with anything; a cine may lack its mark.
  if (extension == ".mraw") return FileKind::kMraw;
  if (extension == ".cih" || extension == ".cihx") return FileKind::kCih;
  if (extension == ".cine") return FileKind::kCine;
  if (extension == ".tif" || extension == ".tiff") return FileKind::kTiff;
  return FileKind::kUnknown;
}

}  // namespace impactdic::video
