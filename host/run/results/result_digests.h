// SHA256SUMS: what the files of a result folder were when their run ended. `sha256sum -c` reads it
// too.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace impactdic::run {

inline constexpr const char* kDigestsName = "SHA256SUMS";

// Of the files that runs write into `folder`, those of its own sub-folders among them; in one step.
// Throws FileError.
void write_digests(const std::filesystem::path& folder);

enum class FileState { kSame, kChanged, kShorter, kLonger, kMissing };
const char* to_string(FileState state);

struct CheckedFile {
  std::string file;  // from the folder on
  FileState state = FileState::kSame;
};

struct CheckedResults {
  std::vector<CheckedFile> files;
  std::string version;  // of the program that wrote them
  std::size_t folders = 0;
};

// Compares with SHA256SUMS the files of `folder`, and of the folders in it that have one, such as a
// batch's shots. Throws FileError where it has none, FormatError where that is damaged or names a
// file outside of its folder.
CheckedResults check_digests(const std::filesystem::path& folder);

}  // namespace impactdic::run
