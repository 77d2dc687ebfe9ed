#include "host/video/clip_digest.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <future>
#include <thread>
#include <vector>

#include "host/base/sha256.h"

namespace impactdic::video {

namespace {

// A disk has no more to give to more of them.
constexpr unsigned kMostThreads = 8;

// Every so-manieth piece.
std::vector<std::string> digests_of_pieces(const std::string& path, std::uint64_t piece_bytes,
                                           std::size_t first, std::size_t pieces,
                                           std::size_t step) {
  std::vector<std::string> digests;
  for (std::size_t i = first; i < pieces; i += step) {
    digests.push_back(sha256_of_part(path, i * piece_bytes, piece_bytes));
  }
  return digests;
}

std::string digest_of_file(const std::string& path, std::uint64_t piece_bytes) {
  std::error_code unknown;
  const std::uint64_t size = std::filesystem::file_size(path, unknown);
  if (unknown || size <= piece_bytes) return sha256_of_file(path);
  const std::size_t pieces = (size + piece_bytes - 1) / piece_bytes;
  const unsigned half = std::clamp(std::thread::hardware_concurrency() / 2, 1u, kMostThreads);
  const std::size_t threads = std::min<std::size_t>(half, pieces);
  // Not oneTBB's threads: a thread that stands back begins others that do.
  std::vector<std::future<std::vector<std::string>>> parts;
  for (std::size_t k = 0; k < threads; ++k) {
    parts.push_back(std::async(std::launch::async, digests_of_pieces, std::cref(path), piece_bytes,
                               k, pieces, threads));
  }
  std::vector<std::vector<std::string>> digests;
  for (auto& part : parts) digests.push_back(part.get());
  std::string listing;
  for (std::size_t i = 0; i < pieces; ++i) listing += digests[i % threads][i / threads] + "  -\n";
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
