// Programs compiled before they are asked for, side by side: drivers of GPUs compile one program at
// a time in a process, so that other processes (impactdic-compile) do it and leave what they made
// in the cache of programs. Whoever waits for one that never comes compiles it itself.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "host/base/process/helper_program.h"

namespace impactdic::opencl {

// A program that is to be compiled: its key in the cache, its source in kernels/ and all options.
// Those that are not sure to be needed come behind all others, when these are done.
struct AheadTask {
  std::string key, file, options;
  bool is_sure = true;
};

// Who compiles: at most `count` processes of `program`, on the device of this index, into `cache`.
struct AheadHelpers {
  std::string program;
  int count = 0;
  int device = 0;
  std::filesystem::path cache;
  std::string kernel_dir;
  bool keeps_binaries = true;  // as the engine that will ask for them
};

// What helpers are given beside standard input, which ends when nobody waits for them any more.
inline constexpr int kAheadTasks = 3;  // a byte is the number of the next task
inline constexpr int kAheadTurn = 4;   // ends when it is this process's turn to open the device
inline constexpr int kAheadNext = 5;   // closed when the device is open: the next one's turn
inline constexpr int kAheadSure = 6;   // ends when nobody works on what is sure any more
inline constexpr int kAheadWork = 7;   // closed by who does not: the other end of that

class CompileAhead {
 public:
  // Starts the processes, which take the tasks in their order (the first 256 of them; those that
  // are sure come first). Where they cannot be started the object is of no use, and does no harm.
  CompileAhead(const AheadHelpers& helpers, std::vector<AheadTask> tasks);
  ~CompileAhead();  // ends those that still run
  CompileAhead(const CompileAhead&) = delete;
  CompileAhead& operator=(const CompileAhead&) = delete;

  // Waits until there is a file at `entry`, where the cache keeps the program of this key; not
  // where it is none of the tasks, no process is at work any more, or a minute has passed since the
  // start.
  void await(const std::string& key, const std::filesystem::path& entry) const;

 private:
  struct Running;
  // What a process is given, but for what all have alike.
  struct Turn {
    int begins = -1, ends = -1;
  };
  bool start(const AheadHelpers& helpers, const Turn& turn);

  std::vector<AheadTask> tasks_;
  Descriptor alive_, their_alive_, their_tasks_, sure_, work_;
  std::shared_ptr<Running> running_;
  std::chrono::steady_clock::time_point began_;
};

}  // namespace impactdic::opencl
