#include "host/base/process_name.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <sstream>

namespace impactdic {
namespace {

std::string host_name() {
  std::array<char, 256> name = {};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

// "" where none runs, where it has ended and its parent has not looked, or nothing is known of it.
std::string start_of(long pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string text;
  if (!std::getline(file, text)) return "";
  std::istringstream fields(text.substr(std::min(text.size(), text.rfind(')') + 2)));
  std::string state, field;
  fields >> state;
  if (state == "Z" || state == "X") return "";
  for (int i = 0; i < 19; ++i) fields >> field;  // the 22nd of proc(5)
  return field;
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

}  // namespace impactdic
