#include "host/run/results/folder_lock.h"

#include <fcntl.h>
#include <impactdic/error.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <sstream>
#include <system_error>

namespace impactdic::run {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr seconds kTouchEvery{10};
// Without the system's locks: after that, who wrote last has the folder.
constexpr milliseconds kSettles{300};
constexpr int kTries = 50;

std::string host_name() {
  std::array<char, 256> name = {};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

// When a process began, which tells it from a later one of the same number; "" where none runs or
// nothing is known of it.
std::string start_of(long pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string text;
  if (!std::getline(file, text)) return "";
  std::istringstream fields(text.substr(std::min(text.size(), text.rfind(')') + 2)));
  std::string field;
  for (int i = 0; i < 20; ++i) fields >> field;  // the 22nd of proc(5)
  return field;
}

struct Owner {
  std::string host, start;
  long pid = 0;
};

Owner this_process() { return {host_name(), start_of(::getpid()), ::getpid()}; }

std::string text_of(const Owner& owner) {
  return "host " + owner.host + "\npid " + std::to_string(owner.pid) + "\nstart " + owner.start +
         "\n";
}

Owner read_owner(const fs::path& path) {
  std::ifstream file(path);
  Owner owner;
  for (std::string key; file >> key;) {
    if (key == "host") file >> owner.host;
    if (key == "pid") file >> owner.pid;
    if (key == "start") file >> owner.start;
  }
  return owner;
}

// The file system's clock, which need not be this machine's.
fs::file_time_type now_at(const fs::path& folder) {
  const fs::path probe = folder / (std::string(FolderLock::kName) + "." + host_name() + "." +
                                   std::to_string(::getpid()));
  std::ofstream(probe) << '\n';
  std::error_code error;
  const auto now = fs::last_write_time(probe, error);
  fs::remove(probe, error);
  return now;
}

bool is_alive(const Owner& owner, const fs::path& path) {
  if (owner.pid <= 0) return false;
  if (owner.host == host_name()) {
    if (::kill(static_cast<pid_t>(owner.pid), 0) != 0 && errno == ESRCH) return false;
    return owner.start.empty() || owner.start == start_of(owner.pid);
  }
  std::error_code error;
  const auto touched = fs::last_write_time(path, error);
  return !error && now_at(path.parent_path()) - touched < FolderLock::kSilence;
}

[[noreturn]] void refuse(const Owner& owner, const fs::path& folder) {
  std::string who = "another run";
  if (owner.pid > 0) {
    who = "process " + std::to_string(owner.pid) + " on " + owner.host;
  }
  throw Error(who + " writes into this folder", folder.string(),
              "wait for its end, or name another folder with -o");
}

enum class Taken { kYes, kNo, kUnsupported };

Taken lock_file(int file) {
  struct flock lock = {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  if (::fcntl(file, F_OFD_SETLK, &lock) == 0) return Taken::kYes;
  return errno == EAGAIN || errno == EACCES ? Taken::kNo : Taken::kUnsupported;
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

// False where the file went away meanwhile.
bool FolderLock::try_take() {
  file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
  if (file_ < 0) {
    const int code = errno;
    throw FileError("cannot write into the folder: " + std::generic_category().message(code),
                    folder_.string());
  }
  const Taken taken = lock_file(file_);
  const Owner owner = read_owner(path_);
  system_locks_ = taken != Taken::kUnsupported;
  // With the system's lock in hand a process of this machine cannot be its owner any more.
  const bool may_live = !system_locks_ || owner.host != host_name();
  if (taken == Taken::kNo || (may_live && is_alive(owner, path_))) {
    give_up();
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
  const Owner self = this_process();
  const std::string text = text_of(self);
  if (::ftruncate(file_, 0) != 0 ||
      ::pwrite(file_, text.data(), text.size(), 0) != static_cast<ssize_t>(text.size())) {
    throw FileError("cannot write the file", path_.string(), "is the disk full?");
  }
  if (system_locks_) return;
  std::this_thread::sleep_for(kSettles);
  const Owner now = read_owner(path_);
  if (now.pid != self.pid || now.host != self.host || now.start != self.start) {
    refuse(now, folder_);
  }
}

}  // namespace impactdic::run
