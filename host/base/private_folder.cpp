#include "host/base/private_folder.h"

#include <impactdic/error.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>

namespace impactdic {

bool make_private_folder(const std::filesystem::path& folder) {
  std::error_code error;
  if (folder.has_parent_path()) std::filesystem::create_directories(folder.parent_path(), error);
  if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) return false;
  return is_trusted_folder(folder);
}

bool is_trusted_folder(const std::filesystem::path& folder) {
  struct stat found = {};
  if (::stat(folder.c_str(), &found) != 0 || !S_ISDIR(found.st_mode)) return false;
  const bool own = found.st_uid == ::geteuid();
  if ((!own && found.st_uid != 0) || (found.st_mode & S_IWOTH) != 0) return false;
  if ((found.st_mode & S_IWGRP) == 0) return true;
  return own && ::chmod(folder.c_str(), found.st_mode & 07755U & ~mode_t{S_IWGRP}) == 0;
}

ScratchFolder::ScratchFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "impactdic_XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw FileError("cannot make a folder", name);
  path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace impactdic
