#include "host/video/clip_digest.h"

#include <algorithm>
#include <filesystem>
#include <thread>
#include <vector>

#include "host/base/parallel/parallel_for.h"
#include "host/base/sha256.h"

namespace impactdic::video {

namespace {

// Most of the cores are the measurement's.
int threads_for(std::size_t pieces) {
  const unsigned spare = std::clamp(std::thread::hardware_concurrency() / 4, 1u, 4u);
  return static_cast<int>(std::min<std::size_t>(spare, pieces));
}

std::string digest_of_file(const std::string& path, std::uint64_t piece_bytes) {
  std::error_code unknown;
  const std::uint64_t size = std::filesystem::file_size(path, unknown);
  if (unknown || size <= piece_bytes) return sha256_of_file(path);
  std::vector<std::string> digests((size + piece_bytes - 1) / piece_bytes);
  parallel_for(digests.size(), threads_for(digests.size()), [&](std::size_t i) {
    digests[i] = sha256_of_part(path, i * piece_bytes, piece_bytes);
  });
  std::string listing;
  for (const std::string& digest : digests) listing += digest + "  -\n";
  return sha256_of_text(listing);
}

}  // namespace

ClipDigest digest_of(const ClipInfo& info, std::uint64_t piece_bytes) {
  ClipDigest digest;
  if (!info.header_path.empty()) digest.header_sha256 = sha256_of_file(info.header_path);
  if (info.files.empty()) {
    digest.sha256 = digest_of_file(info.path, piece_bytes);
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

}  // namespace impactdic::video
