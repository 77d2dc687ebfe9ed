// Compiled programs on disk. An entry's key holds everything that its binary depends on: source,
// options, platform, device and driver version. A damaged or foreign entry is deleted, never used.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace impactdic::opencl {

class ProgramCache {
 public:
  // `folder` is made when the first entry is written; "" turns the cache off.
  explicit ProgramCache(std::filesystem::path folder) : folder_(std::move(folder)) {}
  // $IMPACTDIC_CACHE_DIR, else $XDG_CACHE_HOME/impactdic, else ~/.cache/impactdic, else off.
  static std::filesystem::path default_folder();

  std::optional<std::vector<unsigned char>> load(const std::string& key) const;
  // Writes to a temporary file and renames it, so that readers see whole entries only. A cache
  // that cannot be written is a warning in the log, not an error.
  void store(const std::string& key, const std::vector<unsigned char>& binary) const;
  void remove(const std::string& key) const;
  // Where an entry is, or would be; where the cache is on.
  std::filesystem::path path_of(const std::string& key) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace impactdic::opencl
