#include "tests/fuzz/fuzz_share.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>

#include "host/base/parse.h"
#include "host/base/process_name.h"
#include "host/cluster/launcher.h"
#include "host/cluster/work_queue.h"
#include "tests/unit/cluster/memory_files.h"

namespace impactdic::fuzz {
namespace {

constexpr int kMostSteps = 200;  // of a share of a few lines: more is a queue that never ends

std::map<std::string, std::string> lines_of(const std::string& text) {
  std::map<std::string, std::string> values;
  for (const std::string& line : split(text, '\n')) {
    const std::size_t equal = line.find('=');
    if (equal == std::string::npos) continue;
    values[line.substr(0, equal)] = line.substr(equal + 1);
  }
  return values;
}

void make_folders(testing::MemoryFiles& files, const std::string& path) {
  for (std::size_t at = path.find('/'); at != std::string::npos; at = path.find('/', at + 1)) {
    files.make_folder(path.substr(0, at));
  }
}

}  // namespace

void read_share(const std::string& text) {
  testing::MemoryFiles files;
  for (const char* folder : {"s/todo", "s/taken", "s/members", "s/lost", "s/closing"}) {
    make_folders(files, std::string(folder) + "/");
  }
  for (const auto& [path, value] : lines_of(text)) {
    // A ticket lies in a tray, all else in one of the folders; a folder is no file.
    const auto depth = std::count(path.begin(), path.end(), '/');
    if (depth != (path.starts_with("todo/") ? 2
                  : path == "list"          ? 0
                                            : 1) ||
        path.find("//") != std::string::npos || path.back() == '/' || path.front() == '/') {
      continue;
    }
    make_folders(files, "s/" + path);
    files.write("s/" + path, value);
  }
  files.write("s/settings", "same");
  cluster::QueueOptions options;
  options.name = "s";
  options.member = "me";
  double now_s = 0;
  cluster::WorkQueue queue(
      files, options, [&] { return now_s; },
      [](const std::string& beat) { return is_gone(parse_process(beat)); });
  if (!queue.open("same", [] { return std::vector<std::string>{"a"}; })) std::abort();
  for (int step = 0;; ++step, now_s += 30) {
    if (step == kMostSteps) std::abort();
    queue.beat();
    while (const auto ticket = queue.take()) {
      if (!queue.finish(*ticket) && queue.holds(*ticket)) std::abort();
    }
    if (queue.look() == cluster::Outlook::kOver) break;
  }
  queue.list();
  queue.lost();
  if (queue.take_closing() == cluster::Closing::kMine) queue.close();
}

void read_launch(const std::string& text) {
  const std::map<std::string, std::string> values = lines_of(text);
  const cluster::Launch launch = cluster::tell_launch([&](const char* name) -> const char* {
    const auto found = values.find(name);
    return found == values.end() ? nullptr : found->second.c_str();
  });
  if (launch.rank < 0 || launch.rank >= launch.size || launch.local_rank < 0 ||
      launch.local_rank >= launch.local_size) {
    std::abort();
  }
}

}  // namespace impactdic::fuzz
