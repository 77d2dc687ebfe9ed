// What sharing work asks of a file system. Only what NFS, too, does as a whole or not at all.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace impactdic::cluster {

// Paths lie in one folder that every process sees; '/' divides their parts. All throw FileError
// where the file system refuses. Safe to be called from several threads.
class Files {
 public:
  virtual ~Files() = default;
  // Renames a file or a folder. False where `from` or the folder of `to` is not there (any more),
  // or where `to` is a folder that holds something.
  virtual bool move(const std::string& from, const std::string& to) = 0;
  // False where it is there already.
  virtual bool make_folder(const std::string& path) = 0;
  // Only an empty folder; false where it holds something or is not there.
  virtual bool remove_folder(const std::string& path) = 0;
  virtual bool remove(const std::string& path) = 0;  // a file; false where it is not there
  virtual bool exists(const std::string& path) = 0;
  // Sorted; empty where there is no such folder.
  virtual std::vector<std::string> names_in(const std::string& folder) = 0;
  virtual std::optional<std::string> read(const std::string& path) = 0;
  virtual void write(const std::string& path, const std::string& text) = 0;  // in place of what was
};

class DiskFiles : public Files {
 public:
  // Makes `root` where it is missing.
  explicit DiskFiles(std::filesystem::path root);
  bool move(const std::string& from, const std::string& to) override;
  bool make_folder(const std::string& path) override;
  bool remove_folder(const std::string& path) override;
  bool remove(const std::string& path) override;
  bool exists(const std::string& path) override;
  std::vector<std::string> names_in(const std::string& folder) override;
  std::optional<std::string> read(const std::string& path) override;
  void write(const std::string& path, const std::string& text) override;

 private:
  std::filesystem::path root_;
};

}  // namespace impactdic::cluster
