#include "host/run/batch/joined_table.h"

#include <algorithm>
#include <fstream>

#include "host/report/shots_csv.h"
#include "host/run/batch/shot_line.h"
#include "host/run/folder.h"
#include "host/run/results/result_digests.h"

namespace impactdic::run {

namespace fs = std::filesystem;

BatchResult join_results(const BatchRequest& request, const ShotRunner& runner,
                         cluster::WorkQueue& queue) {
  BatchResult result;
  result.table = (runner.output() / "shots.csv").string();
  for (const std::string& line : queue.list()) {
    const BatchShot shot = parse_shot_line(line, request.share.name);
    if (runner.is_done(shot)) {
      result.shots.push_back(runner.read_done(shot));
      continue;
    }
    ShotResult& entry = result.shots.emplace_back(runner.described(shot));
    std::ifstream reason(runner.aside(shot) / "reason.txt");
    entry.missing = !std::getline(reason, entry.reason);
    if (entry.missing) entry.reason = "no process has measured it";
    ++(entry.missing ? result.missing : result.failed);
  }
  for (const std::string& lost : queue.lost()) {
    result.warnings.push_back(lost + " was lost; others measured its shots");
  }
  return result;
}

void write_joined(const BatchRequest& request, const ShotRunner& runner,
                  const BatchResult& result) {
  std::vector<std::string> lines;
  for (const ShotResult& shot : result.shots) lines.push_back(report::shots_csv_line(shot));
  report::write_shots_csv(result.table, lines);
  if (result.missing == 0) {
    std::vector<fs::path> left;
    for (const auto& entry : fs::directory_iterator(runner.shots())) {
      const std::string name = entry.path().filename().string();
      if (name.find(".part-") != std::string::npos) left.push_back(entry.path());
    }
    std::error_code at_work;  // of a process that was given up too early, and will see it
    for (const fs::path& part : left) fs::remove_all(part, at_work);
  }
  if (request.output.checksum) write_digests(runner.output());
}

}  // namespace impactdic::run
