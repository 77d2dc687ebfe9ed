// Folders whose files this program believes, such as those of compiled kernels: nobody else may put
// anything there.
#pragma once

#include <filesystem>

namespace impactdic {

// Makes the folder, for its owner alone (0700), with those above it. False where that cannot be, or
// where the folder is not to be trusted.
bool make_private_folder(const std::filesystem::path& folder);

// Whether the folder belongs to this user or to root and not everybody may write into it. From a
// folder of this user's the group's right to write is taken away, which a lax umask leaves.
bool is_trusted_folder(const std::filesystem::path& folder);

// A folder made for its owner alone among the system's temporary ones, and gone with the object.
class ScratchFolder {
 public:
  ScratchFolder();  // throws FileError
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace impactdic
