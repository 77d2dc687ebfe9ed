#include "host/run/results/result_digests.h"

#include <impactdic/error.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>

#include "host/base/parse.h"
#include "host/base/sha256.h"

namespace impactdic::run {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kDigestLength = 64;
constexpr std::array kFiles = {"fields.h5",   "job.toml",     "motion.csv",
                               "overlay.mp4", "pose.csv",     "resume.json",
                               "shots.csv",   "summary.json", "track.csv"};
constexpr std::array kFolders = {"key_frames", "overlay"};

std::vector<std::string> result_files(const fs::path& folder) {
  std::vector<std::string> files;
  for (const char* name : kFiles) {
    if (fs::is_regular_file(folder / name)) files.emplace_back(name);
  }
  for (const char* name : kFolders) {
    if (!fs::is_directory(folder / name)) continue;
    for (const auto& entry : fs::directory_iterator(folder / name)) {
      if (!entry.is_regular_file()) continue;
      files.push_back(std::string(name) + "/" + entry.path().filename().string());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

// One line of SHA256SUMS, and the comment before it.
struct Noted {
  std::string digest, file;
  std::uintmax_t bytes = 0;
};

[[noreturn]] void refuse(const fs::path& path, int line) {
  throw FormatError(path.string() + ", line " + std::to_string(line), -1,
                    "this is no list of digests");
}

// A name that stays in its folder.
bool is_inside(const std::string& name) {
  const fs::path path(name);
  if (name.empty() || path.is_absolute()) return false;
  return std::none_of(path.begin(), path.end(), [](const fs::path& part) { return part == ".."; });
}

std::vector<Noted> read_digests(const fs::path& path, std::string& version) {
  std::ifstream file(path);
  if (!file) {
    throw FileError("the folder holds no digests of its files", path.string(),
                    "its run was interrupted, made with --no-checksum, or by another program");
  }
  std::vector<Noted> noted;
  std::uintmax_t bytes = 0;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    std::istringstream words(line);
    std::string hash, key;
    if (line.starts_with('#')) {
      words >> hash >> key;
      if (key == "impactdic") words >> version;
      if (key == "bytes") words >> bytes;
      continue;
    }
    Noted next{line.substr(0, kDigestLength), "", bytes};
    const bool good = line.size() > kDigestLength + 2 && line.substr(kDigestLength, 2) == "  " &&
                      next.digest.find_first_not_of("0123456789abcdef") == std::string::npos;
    if (!good) refuse(path, number);
    next.file = line.substr(kDigestLength + 2);
    if (!is_inside(next.file)) refuse(path, number);
    noted.push_back(std::move(next));
  }
  return noted;
}

FileState state_of(const fs::path& file, const Noted& noted) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return FileState::kMissing;
  const std::uintmax_t bytes = fs::file_size(file, error);
  if (bytes < noted.bytes) return FileState::kShorter;
  if (bytes > noted.bytes) return FileState::kLonger;
  return sha256_of_file(file.string()) == noted.digest ? FileState::kSame : FileState::kChanged;
}

void check_folder(const fs::path& folder, const std::string& prefix, CheckedResults& results) {
  for (const Noted& noted : read_digests(folder / kDigestsName, results.version)) {
    results.files.push_back({prefix + noted.file, state_of(folder / noted.file, noted)});
  }
  ++results.folders;
}

}  // namespace

const char* to_string(FileState state) {
  switch (state) {
    case FileState::kSame:
      return "same";
    case FileState::kChanged:
      return "changed";
    case FileState::kShorter:
      return "cut off";
    case FileState::kLonger:
      return "longer";
    case FileState::kMissing:
      return "missing";
  }
  return "";
}

void write_digests(const fs::path& folder) {
  const fs::path path = folder / kDigestsName, part = path.string() + ".part";
  {
    std::ofstream file(part);
    file << "# impactdic " << IMPACTDIC_VERSION << '\n';
    for (const std::string& name : result_files(folder)) {
      file << "# bytes " << fs::file_size(folder / name) << '\n'
           << sha256_of_file((folder / name).string()) << "  " << name << '\n';
    }
    file << std::flush;
    if (!file) throw FileError("cannot write the file", path.string(), "is the disk full?");
  }
  std::error_code error;
  fs::rename(part, path, error);
  if (error) throw FileError("cannot replace the file: " + error.message(), path.string());
}

CheckedResults check_digests(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw InvalidArgument("there is no such folder", folder.string());
  CheckedResults results;
  check_folder(folder, "", results);
  std::vector<fs::path> inside;
  if (fs::is_directory(folder / "shots")) {
    for (const auto& entry : fs::directory_iterator(folder / "shots")) {
      if (fs::exists(entry.path() / kDigestsName)) inside.push_back(entry.path());
    }
  }
  std::sort(inside.begin(), inside.end());
  for (const fs::path& shot : inside) {
    check_folder(shot, "shots/" + shot.filename().string() + "/", results);
  }
  return results;
}

}  // namespace impactdic::run
