// A file that is whole after every commit, at whatever instant its writer is killed. What lies
// before the end of the last commit is never written in place: changes to it are gathered in
// memory, put into a journal beside the file at the next commit, and only then into the file. A
// journal that is left behind was written in full, and whoever opens the file next finishes it
// (redo log: J. Gray, A. Reuter, "Transaction Processing", 1993, chapter 9). That holds where the
// program is killed; a machine that loses power may lose what its disk has not yet taken.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <utility>
#include <vector>

namespace impactdic::report {

class JournaledFile {
 public:
  // Starts the file anew. It gets its name at the first commit, in one step. Throws FileError here
  // and below.
  static JournaledFile create(std::filesystem::path path);
  // Opens it for reading and writing, after the end of a commit that was interrupted.
  static JournaledFile open(std::filesystem::path path);
  JournaledFile(JournaledFile&& other) noexcept;
  JournaledFile& operator=(JournaledFile&&) = delete;
  // Changes since the last commit are lost.
  ~JournaledFile();

  // Bytes beyond the file's end read as zero.
  void read(std::uint64_t at, std::span<std::uint8_t> bytes) const;
  void write(std::uint64_t at, std::span<const std::uint8_t> bytes);
  void resize(std::uint64_t size) { size_ = size; }
  std::uint64_t size() const { return size_; }
  // From here on the file holds what was written, and has this size.
  void commit();
  // Device and inode.
  std::pair<std::uint64_t, std::uint64_t> identity() const;

  // Where a commit's changes stand until they are in the file.
  static std::filesystem::path journal_of(const std::filesystem::path& file);

 private:
  JournaledFile(std::filesystem::path path, bool is_new);
  std::filesystem::path unnamed() const { return path_.string() + ".new"; }
  void read_file(std::uint64_t at, std::span<std::uint8_t> bytes) const;
  void write_file(std::uint64_t at, std::span<const std::uint8_t> bytes);
  void write_journal() const;
  void apply_journal();
  std::vector<std::uint8_t>& page(std::uint64_t index);

  std::filesystem::path path_;
  int file_ = -1;
  bool is_new_ = false;          // not committed yet
  bool applying_ = false;        // its journal is not all in it
  std::uint64_t committed_ = 0;  // bytes that must stay as they are until the next commit
  std::uint64_t size_ = 0;
  std::map<std::uint64_t, std::vector<std::uint8_t>> pages_;  // changed ones before `committed_`
};

}  // namespace impactdic::report
