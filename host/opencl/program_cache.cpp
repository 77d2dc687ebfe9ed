#include "host/opencl/program_cache.h"

#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

#include "host/base/log.h"
#include "host/base/private_folder.h"
#include "host/base/sha256.h"

namespace impactdic::opencl {

namespace {

constexpr std::size_t kDigestLength = 64;  // hexadecimal SHA-256

// An entry is the digest of what follows it: the key, a zero byte, the binary.
std::string entry_of(const std::string& key, const std::vector<unsigned char>& binary) {
  std::string body = key;
  body.push_back('\0');
  body.append(reinterpret_cast<const char*>(binary.data()), binary.size());
  return sha256_of_text(body) + body;
}

}  // namespace

std::filesystem::path ProgramCache::default_folder() {
  if (const char* own = std::getenv("IMPACTDIC_CACHE_DIR")) return own;
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache != '\0') {
    return std::filesystem::path(cache) / "impactdic";
  }
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0') {
    return std::filesystem::path(home) / ".cache" / "impactdic";
  }
  return {};
}

std::filesystem::path ProgramCache::path_of(const std::string& key) const {
  return folder_ / (sha256_of_text(key) + ".clbin");
}

std::optional<std::vector<unsigned char>> ProgramCache::load(const std::string& key) const {
  if (folder_.empty()) return std::nullopt;
  std::ifstream file(path_of(key), std::ios::binary);
  if (!file) return std::nullopt;
  if (!is_trusted_folder(folder_)) {
    library_log().warn("the kernel cache {} is not used: others may write into it",
                       folder_.string());
    return std::nullopt;
  }
  const std::string entry((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const std::size_t head = kDigestLength + key.size() + 1;
  if (entry.size() <= head || entry.compare(kDigestLength, key.size(), key) != 0 ||
      entry[head - 1] != '\0' ||
      sha256_of_text(std::string_view(entry).substr(kDigestLength)) !=
          std::string_view(entry).substr(0, kDigestLength)) {
    remove(key);
    return std::nullopt;
  }
  return std::vector<unsigned char>(entry.begin() + static_cast<std::ptrdiff_t>(head), entry.end());
}

void ProgramCache::store(const std::string& key, const std::vector<unsigned char>& binary) const {
  if (folder_.empty()) return;
  std::error_code error;
  if (!make_private_folder(folder_)) {
    library_log().warn("the kernel cache {} cannot be made, or others may write into it",
                       folder_.string());
    return;
  }
  const std::filesystem::path target = path_of(key);
  const std::filesystem::path temporary = target.string() + "." + std::to_string(getpid());
  {
    std::ofstream file(temporary, std::ios::binary);
    file << entry_of(key, binary) << std::flush;
    if (!file) {
      library_log().warn("the kernel cache {} cannot be written", folder_.string());
      std::filesystem::remove(temporary, error);
      return;
    }
  }
  std::filesystem::rename(temporary, target, error);
  if (error) std::filesystem::remove(temporary, error);
}

void ProgramCache::remove(const std::string& key) const {
  std::error_code ignored;
  std::filesystem::remove(path_of(key), ignored);
}

}  // namespace impactdic::opencl
