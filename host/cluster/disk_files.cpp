#include <impactdic/error.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include "host/cluster/files.h"

namespace impactdic::cluster {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& what, const fs::path& path, int code) {
  throw FileError(what + ": " + std::generic_category().message(code), path.string());
}

// ESTALE: another machine has taken it away while this one still knew it.
bool is_absent(int code) { return code == ENOENT || code == ENOTDIR || code == ESTALE; }

}  // namespace

DiskFiles::DiskFiles(fs::path root) : root_(std::move(root)) {
  std::error_code error;
  fs::create_directories(root_, error);
  if (error) refuse("cannot make the folder", root_, error.value());
}

bool DiskFiles::move(const std::string& from, const std::string& to) {
  const fs::path source = root_ / from, target = root_ / to;
  if (::rename(source.c_str(), target.c_str()) == 0) return true;
  if (is_absent(errno) || errno == ENOTEMPTY || errno == EEXIST) return false;
  refuse("cannot rename", source, errno);
}

bool DiskFiles::make_folder(const std::string& path) {
  if (::mkdir((root_ / path).c_str(), 0777) == 0) return true;
  if (errno == EEXIST) return false;
  refuse("cannot make the folder", root_ / path, errno);
}

bool DiskFiles::remove_folder(const std::string& path) {
  if (::rmdir((root_ / path).c_str()) == 0) return true;
  if (is_absent(errno) || errno == ENOTEMPTY || errno == EEXIST || errno == EBUSY) return false;
  refuse("cannot remove the folder", root_ / path, errno);
}

bool DiskFiles::remove(const std::string& path) {
  if (::unlink((root_ / path).c_str()) == 0) return true;
  if (is_absent(errno)) return false;
  refuse("cannot remove", root_ / path, errno);
}

bool DiskFiles::exists(const std::string& path) {
  return ::access((root_ / path).c_str(), F_OK) == 0;
}

std::vector<std::string> DiskFiles::names_in(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(root_ / folder, error), end; !error && entry != end;
       entry.increment(error)) {
    names.push_back(entry->path().filename().string());
  }
  if (error && !is_absent(error.value())) {
    refuse("cannot list the folder", root_ / folder, error.value());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::optional<std::string> DiskFiles::read(const std::string& path) {
  // Opened anew each time: that is when NFS looks for what other machines have written.
  std::ifstream file(root_ / path, std::ios::binary);
  if (!file) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
}

void DiskFiles::write(const std::string& path, const std::string& text) {
  std::ofstream file(root_ / path, std::ios::binary | std::ios::trunc);
  file << text << std::flush;
  if (!file) {
    throw FileError("cannot write the file", (root_ / path).string(), "is the disk full?");
  }
}

}  // namespace impactdic::cluster
