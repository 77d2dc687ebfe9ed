// One run at a time writes into a folder.
#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

namespace impactdic::run {

// Holds the folder from construction to destruction by a file in it, which says who does. The
// system's lock on that file ends with its process however that ends, and NFS passes it on
// (fcntl(2), open file description locks). Where a file system has no such locks, or keeps them to
// one machine, what the file says counts: its owner is alive where its process runs on this
// machine, or where it has touched the file within kSilence. A dead owner's folder is taken over.
class FolderLock {
 public:
  static constexpr const char* kName = ".impactdic.lock";
  static constexpr std::chrono::seconds kSilence{60};

  // Throws Error naming the owner where another run holds the folder, FileError where the folder
  // cannot be written.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  bool outlive_owner() const;
  bool try_take();
  void claim();
  void give_up();

  std::filesystem::path folder_, path_;
  int file_ = -1;
  bool system_locks_ = true;
  std::mutex mutex_;
  std::condition_variable_any ended_;
  std::jthread alive_;  // touches the file now and then
};

}  // namespace impactdic::run
