#include "host/video/clip_digest.h"

#include <filesystem>

#include "host/base/sha256.h"

namespace impactdic {

ClipDigest digest_of(const VideoInfo& info) {
  ClipDigest digest;
  if (!info.header_path.empty()) digest.header_sha256 = sha256_of_file(info.header_path);
  if (info.files.empty()) {
    digest.sha256 = sha256_of_file(info.path);
    return digest;
  }
  std::string listing;
  for (const std::string& file : info.files) {
    const std::string name = std::filesystem::path(file).filename().string();
    listing += sha256_of_file(file) + "  " + name + "\n";
  }
  digest.sha256 = sha256_of_text(listing);
  return digest;
}

}  // namespace impactdic
