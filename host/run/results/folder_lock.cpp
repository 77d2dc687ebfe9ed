#include "host/run/results/folder_lock.h"

#include <fcntl.h>
#include <impactdic/error.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <iterator>
#include <system_error>

#include "host/base/process_name.h"

namespace impactdic::run {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr seconds kTouchEvery{10};
// Without the system's locks: after that, who wrote last has the folder.
constexpr milliseconds kSettles{300};
constexpr int kTries = 50;
// So long a killed run may take to give back what it holds.
constexpr seconds kEnds{10};
constexpr milliseconds kLooksAgain{20};

ProcessName read_owner(const fs::path& path) {
  std::ifstream file(path);
  return parse_process({std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()});
}

// The file system's clock, which need not be this machine's.
fs::file_time_type now_at(const fs::path& folder) {
  const fs::path probe = folder / (std::string(FolderLock::kName) + "." + this_process().host +
                                   "." + std::to_string(::getpid()));
  std::ofstream(probe) << '\n';
  std::error_code error;
  const auto now = fs::last_write_time(probe, error);
  fs::remove(probe, error);
  return now;
}

bool is_alive(const ProcessName& owner, const fs::path& path) {
  if (owner.pid <= 0) return false;
  if (owner.host == this_process().host) return !is_gone(owner);
  std::error_code error;
  const auto touched = fs::last_write_time(path, error);
  return !error && now_at(path.parent_path()) - touched < FolderLock::kSilence;
}

[[noreturn]] void refuse(const ProcessName& owner, const fs::path& folder) {
  std::string who = "another run";
  if (owner.pid > 0) {
    who = "process " + std::to_string(owner.pid) + " on " + owner.host;
  }
  throw Error(who + " writes into this folder", folder.string(),
              "wait for its end, or name another folder with -o");
}

enum class Taken { kYes, kNo, kUnsupported };

struct flock whole_file() {
  struct flock lock = {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  return lock;
}

Taken lock_file(int file) {
  struct flock lock = whole_file();
  if (::fcntl(file, F_OFD_SETLK, &lock) == 0) return Taken::kYes;
  return errno == EAGAIN || errno == EACCES ? Taken::kNo : Taken::kUnsupported;
}

// Whether somebody holds the system's lock on it.
bool is_locked(const fs::path& path) {
  const int file = ::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
  if (file < 0) return false;
  struct flock lock = whole_file();
  const bool locked = ::fcntl(file, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
  ::close(file);
  return locked;
}

// Killed, but what it held is not free yet.
bool is_letting_go(const ProcessName& owner, const fs::path& path) {
  return is_ending(owner) && (!is_gone(owner) || is_locked(path));
}

bool is_same_file(int file, const fs::path& path) {
  struct stat held = {}, named = {};
  return ::fstat(file, &held) == 0 && ::stat(path.c_str(), &named) == 0 &&
         held.st_ino == named.st_ino && held.st_dev == named.st_dev;
}

}  // namespace

FolderLock::FolderLock(const fs::path& folder) : folder_(folder), path_(folder / kName) {
  bool taken = false;
  for (int i = 0; i < kTries && !taken; ++i) taken = try_take();
  if (!taken) refuse({}, folder_);
  alive_ = std::jthread([this](const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (!ended_.wait_for(lock, stop, kTouchEvery, [&] { return stop.stop_requested(); })) {
      ::futimens(file_, nullptr);
    }
  });
}

FolderLock::~FolderLock() {
  alive_ = {};
  // Away before the lock is: whoever opened it meanwhile sees that it is gone, and tries again.
  if (is_same_file(file_, path_)) ::unlink(path_.c_str());
  give_up();
}

void FolderLock::give_up() {
  if (file_ >= 0) ::close(file_);
  file_ = -1;
}

// Waits for the end of a run that was killed a moment ago. False where nobody is about to end.
bool FolderLock::outlive_owner() const {
  if (!is_ending(read_owner(path_))) return false;
  const auto until = std::chrono::steady_clock::now() + kEnds;
  while (is_letting_go(read_owner(path_), path_)) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(kLooksAgain);
  }
  return true;
}

// False where the file went away meanwhile, or its owner.
bool FolderLock::try_take() {
  file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
  if (file_ < 0) {
    const int code = errno;
    throw FileError("cannot write into the folder: " + std::generic_category().message(code),
                    folder_.string());
  }
  const Taken taken = lock_file(file_);
  const ProcessName owner = read_owner(path_);
  system_locks_ = taken != Taken::kUnsupported;
  // With the system's lock in hand a process of this machine cannot be its owner any more.
  const bool may_live = !system_locks_ || owner.host != this_process().host;
  if (taken == Taken::kNo || (may_live && is_alive(owner, path_))) {
    give_up();
    if (outlive_owner()) return false;
    refuse(owner, folder_);
  }
  if (!is_same_file(file_, path_)) {
    give_up();
    return false;
  }
  try {
    claim();
  } catch (...) {
    give_up();
    throw;
  }
  return true;
}

// Writes down whose the folder is.
void FolderLock::claim() {
  const ProcessName self = this_process();
  const std::string text = to_text(self);
  if (::ftruncate(file_, 0) != 0 ||
      ::pwrite(file_, text.data(), text.size(), 0) != static_cast<ssize_t>(text.size())) {
    throw FileError("cannot write the file", path_.string(), "is the disk full?");
  }
  if (system_locks_) return;
  std::this_thread::sleep_for(kSettles);
  const ProcessName now = read_owner(path_);
  if (now.pid != self.pid || now.host != self.host || now.start != self.start) {
    refuse(now, folder_);
  }
}

}  // namespace impactdic::run
