#include "host/opencl/ahead/compile_ahead.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <csignal>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

namespace impactdic::opencl {
namespace {

constexpr auto kLongest = std::chrono::minutes(1);
constexpr auto kLookEvery = std::chrono::milliseconds(2);
constexpr std::size_t kMostTasks = 256;
constexpr int kAboveTheirs = 10;  // numbers that no descriptor of theirs has

int above_theirs(const Descriptor& of) {
  return ::fcntl(of.number(), F_DUPFD_CLOEXEC, kAboveTheirs);
}

// A pipe whose ends no other program gets; false where there is none.
bool make_pipe(Descriptor& from, Descriptor& to) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return false;
  const Descriptor first(ends[0]), second(ends[1]);
  from.set(above_theirs(first));
  to.set(above_theirs(second));
  return from.number() >= 0 && to.number() >= 0;
}

}  // namespace

// The processes, of which a thread learns that they have ended; it may outlive the object.
struct CompileAhead::Running {
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<pid_t> children;

  static void watch(const std::shared_ptr<Running>& running, const std::vector<pid_t>& children) {
    for (const pid_t child : children) {
      siginfo_t info;
      while (::waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOWAIT) != 0 &&
             errno == EINTR) {
      }
      {
        const std::lock_guard<std::mutex> lock(running->mutex);
        ::waitpid(child, nullptr, WNOHANG);  // from here on another process may have its number
        std::erase(running->children, child);
      }
      running->changed.notify_all();
    }
  }
};

CompileAhead::CompileAhead(const AheadHelpers& helpers, std::vector<AheadTask> tasks)
    : tasks_(std::move(tasks)),
      running_(std::make_shared<Running>()),
      began_(std::chrono::steady_clock::now()) {
  if (tasks_.size() > kMostTasks) tasks_.resize(kMostTasks);
  Descriptor numbers;
  if (!make_pipe(their_alive_, alive_) || !make_pipe(their_tasks_, numbers) ||
      !make_pipe(sure_, work_)) {
    return;
  }
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    const auto number = static_cast<unsigned char>(i);
    if (::write(numbers.number(), &number, 1) != 1) return;
  }
  numbers.close();
  // Contexts open one after the other whoever asks: so those open first that get the first tasks.
  Descriptor turn;
  {
    const Descriptor at_once(::open("/dev/null", O_RDONLY | O_CLOEXEC));
    turn.set(above_theirs(at_once));
  }
  const int count = std::min(helpers.count, static_cast<int>(tasks_.size()));
  for (int i = 0; i < count; ++i) {
    Descriptor later, next;
    if (!make_pipe(later, next) || !start(helpers, {turn.number(), next.number()})) break;
    turn.set(above_theirs(later));
  }
  for (Descriptor* theirs : {&their_alive_, &their_tasks_, &sure_, &work_}) theirs->close();
  if (running_->children.empty()) return;
  try {
    std::thread(Running::watch, running_, running_->children).detach();
  } catch (const std::system_error&) {  // nobody will say that they have ended
    const std::lock_guard<std::mutex> lock(running_->mutex);
    for (const pid_t child : running_->children) {
      ::kill(child, SIGKILL);
      ::waitpid(child, nullptr, 0);
    }
    running_->children.clear();
  }
}

CompileAhead::~CompileAhead() {
  const std::lock_guard<std::mutex> lock(running_->mutex);
  for (const pid_t child : running_->children) ::kill(child, SIGKILL);
}

bool CompileAhead::start(const AheadHelpers& helpers, const Turn& turn) {
  std::vector<std::string> words = {helpers.program, std::to_string(helpers.device),
                                    helpers.cache.string(), helpers.kernel_dir,
                                    helpers.keeps_binaries ? "binaries" : "notes"};
  words.push_back(std::to_string(std::ranges::count(tasks_, true, &AheadTask::is_sure)));
  for (const AheadTask& task : tasks_) {
    words.push_back(task.file);
    words.push_back(task.options);
  }
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, their_alive_.number(), STDIN_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  const std::pair<int, int> given[] = {{their_tasks_.number(), kAheadTasks},
                                       {turn.begins, kAheadTurn},
                                       {turn.ends, kAheadNext},
                                       {sure_.number(), kAheadSure},
                                       {work_.number(), kAheadWork}};
  for (const auto& [ours, theirs] : given) {
    posix_spawn_file_actions_adddup2(&actions, ours, theirs);
  }
  pid_t child = -1;
  const int error =
      ::posix_spawn(&child, helpers.program.c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error == 0) running_->children.push_back(child);
  return error == 0;
}

void CompileAhead::await(const std::string& key, const std::filesystem::path& entry) const {
  if (std::ranges::none_of(tasks_, [&](const AheadTask& task) { return task.key == key; })) return;
  std::error_code ignored;
  std::unique_lock<std::mutex> lock(running_->mutex);
  while (!running_->children.empty() && !std::filesystem::exists(entry, ignored) &&
         std::chrono::steady_clock::now() < began_ + kLongest) {
    running_->changed.wait_for(lock, kLookEvery);
  }
}

}  // namespace impactdic::opencl
