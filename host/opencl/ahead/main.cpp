// impactdic-compile DEVICE CACHE KERNEL_DIR binaries|notes SURE (FILE OPTIONS)...: compiles
// programs for whoever has started it into the cache of programs, and ends when that one does; the
// first SURE of them are sure to be needed. See compile_ahead.h for what it is given beside.
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <string>
#include <thread>
#include <utility>

#include "host/base/parse.h"
#include "host/opencl/ahead/compile_ahead.h"
#include "host/opencl/engine.h"

namespace impactdic::opencl {
namespace {

constexpr int kFirstTask = 6;  // of the arguments

// One byte of `from`, or false at its end.
bool next_byte(int from, unsigned char& byte) {
  for (;;) {
    const ssize_t read = ::read(from, &byte, 1);
    if (read == 1) return true;
    if (read == 0 || errno != EINTR) return false;
  }
}

void wait_for_end(int of) {
  for (unsigned char byte = 0; next_byte(of, byte);) {
  }
}

// Ends the process without the driver's own end: nothing here is to be kept.
[[noreturn]] void compile(int argc, char** argv) {
  list_devices();  // the driver starts meanwhile
  wait_for_end(kAheadTurn);
  EngineOptions options;
  options.cache_dir = argv[2];
  options.kernel_dir = argv[3];
  options.keep_programs = std::string(argv[4]) == "binaries";
  Engine engine(argv[1], options);
  ::close(kAheadNext);
  const std::int64_t sure = parse_int(argv[5], "the sure tasks");
  bool waits = true;
  for (unsigned char number = 0; next_byte(kAheadTasks, number);) {
    if (number >= sure && std::exchange(waits, false)) {
      ::close(kAheadWork);
      wait_for_end(
          kAheadSure);  // who needs those waits for them, and processors share their memory
    }
    const int at = kFirstTask + 2 * number;
    if (at + 1 >= argc) break;
    try {
      engine.compile(argv[at], argv[at + 1]);
    } catch (const std::exception&) {
      // Who needs it compiles it anew, and is told what is wrong with it.
    }
  }
  ::_exit(EXIT_SUCCESS);
}

}  // namespace
}  // namespace impactdic::opencl

int main(int argc, char** argv) {
  if (argc < impactdic::opencl::kFirstTask) return EXIT_FAILURE;
  ::syscall(SYS_close_range, impactdic::opencl::kAheadWork + 1, ~0U, 0);
  // Ctrl-C goes to the whole group: the caller decides what is still needed.
  std::signal(SIGINT, SIG_IGN);
  std::thread([] {
    impactdic::opencl::wait_for_end(STDIN_FILENO);
    ::_exit(EXIT_FAILURE);
  }).detach();
  try {
    impactdic::opencl::compile(argc, argv);
  } catch (const std::exception&) {
    ::_exit(EXIT_FAILURE);
  }
}
