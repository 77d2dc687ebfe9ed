#include "host/base/process_name.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <vector>

namespace impactdic {
namespace {

std::string host_name() {
  std::array<char, 256> name = {};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

// What /proc/PID/stat says of it, from its state on (the third field of proc(5)): words that are
// empty where there is no such process.
std::vector<std::string> stat_of(long pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string text;
  std::getline(file, text);
  std::istringstream fields(text.substr(std::min(text.size(), text.rfind(')') + 2)));
  std::vector<std::string> words(20);
  for (std::string& word : words) fields >> word;
  return words;
}

bool has_ended(const std::vector<std::string>& stat) { return stat[0] == "Z" || stat[0] == "X"; }

// "" where none runs, where it has ended and its parent has not looked, or nothing is known of it.
std::string start_of(long pid) {
  const std::vector<std::string> stat = stat_of(pid);
  return has_ended(stat) ? "" : stat[19];
}

// Of /proc/PID/status: the signals that wait for its first thread.
bool kill_waits(long pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("SigPnd:")) continue;
    return (std::strtoull(line.c_str() + 7, nullptr, 16) >> (SIGKILL - 1) & 1) != 0;
  }
  return false;
}

}  // namespace

ProcessName this_process() { return {host_name(), start_of(::getpid()), ::getpid()}; }

std::string to_text(const ProcessName& process) {
  return "host " + process.host + "\npid " + std::to_string(process.pid) + "\nstart " +
         process.start + "\n";
}

ProcessName parse_process(const std::string& text) {
  std::istringstream words(text);
  ProcessName process;
  for (std::string key; words >> key;) {
    if (key == "host") words >> process.host;
    if (key == "pid") words >> process.pid;
    if (key == "start") words >> process.start;
  }
  return process;
}

bool is_gone(const ProcessName& process) {
  if (process.pid <= 0 || process.host != host_name()) return false;
  if (::kill(static_cast<pid_t>(process.pid), 0) != 0 && errno == ESRCH) return true;
  return !process.start.empty() && process.start != start_of(process.pid);
}

bool is_ending(const ProcessName& process) {
  if (process.pid <= 0 || process.host != host_name()) return false;
  if (is_gone(process) || kill_waits(process.pid)) return true;
  constexpr unsigned long kExiting = 4;  // PF_EXITING of Linux
  return (std::strtoul(stat_of(process.pid)[6].c_str(), nullptr, 10) & kExiting) != 0;
}

}  // namespace impactdic
