#include "host/run/batch/share_folder.h"

#include <impactdic/error.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <system_error>

#include "host/base/parse.h"
#include "host/base/process_name.h"
#include "host/run/batch/conclude.h"
#include "host/run/batch/shared_batch.h"
#include "host/run/batch/shot_line.h"
#include "host/run/folder.h"
#include "host/run/settings/job_file.h"

namespace impactdic::run {
namespace {

namespace fs = std::filesystem;

bool is_good(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
         c == '_';
}

bool is_over(const fs::path& share) { return fs::exists(share / "closing" / "done"); }

// Throws Error where a member of the share has said not long ago that it lives. `now`: by the file
// system's clock.
void require_silence(const fs::path& share, fs::file_time_type now) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(share / "members", error)) {
    std::ifstream file(entry.path());
    const std::string beat{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    const ProcessName process = parse_process(beat);
    const bool here = process.host == this_process().host;
    const auto written = fs::last_write_time(entry.path(), error);
    const bool silent = here ? is_gone(process) : now - written > FolderLock::kSilence;
    if (silent || error) continue;
    throw Error("process " + std::to_string(process.pid) + " on " + process.host +
                    " shares this folder with others",
                share.parent_path().parent_path().string(),
                "wait for its end, or name another folder with -o");
  }
}

std::vector<fs::path> shares_in(const fs::path& output) {
  std::vector<fs::path> shares;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(output / kShareFolder, error)) {
    if (fs::exists(entry.path() / "settings") && entry.path().extension().empty()) {
      shares.push_back(entry.path());
    }
  }
  std::sort(shares.begin(), shares.end());
  return shares;
}

}  // namespace

void check_share(const BatchRequest& request) {
  const BatchShare& share = request.share;
  if (!std::all_of(share.name.begin(), share.name.end(), is_good)) {
    throw InvalidArgument("'" + share.name + "' is no name for a share", "--share",
                          "letters, digits, '-' and '_'");
  }
  const bool whole = share.shard == 0 && share.shards == 0;
  if (!whole && (share.shard < 1 || share.shard > share.shards)) {
    throw InvalidArgument(
        std::to_string(share.shard) + "/" + std::to_string(share.shards) + " is no shard",
        "--shard", "K/N with K from 1 to N");
  }
  if (!whole && share.name.empty()) throw InvalidArgument("a shard is of a named share", "--shard");
  if (!(share.lost_after_s >= 1 && share.lost_after_s <= 86400)) {
    throw InvalidArgument("must be between 1 and 86400 s, not " + shortest(share.lost_after_s),
                          "--lost-after");
  }
}

std::string member_name() {
  const ProcessName process = this_process();
  std::string name = process.host + "-" + std::to_string(process.pid) + "-" + process.start;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !is_good(c); }, '-');
  return name;
}

cluster::QueueOptions queue_options(const BatchRequest& request, const std::string& member) {
  cluster::QueueOptions options;
  options.name = request.share.name;
  options.member = member;
  options.described = to_text(this_process());
  if (!request.share.member.empty()) options.described += "name " + request.share.member + "\n";
  options.shards = request.share.shards;
  if (request.share.shards > 0) options.shard = request.share.shard - 1;
  options.lost_after_s = request.share.lost_after_s;
  return options;
}

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

bool text_is_gone(const std::string& beat) { return is_gone(parse_process(beat)); }

std::string share_settings(const BatchRequest& request) {
  SettingWriter settings;
  visit_batch(settings, request);
  std::string text = std::string("version ") + IMPACTDIC_VERSION + "\n";
  for (const auto& [key, value] : settings.values()) text += key + " " + to_text(value) + "\n";
  return text + "shards " + std::to_string(request.share.shards) + "\n";
}

std::vector<std::string> start_share(const BatchRequest& request, const Session& session,
                                     const ShotRunner& runner) {
  const TrackFolder& output = request.output;
  const OutputFolder held(output.folder, output.force || output.resume);
  require_no_share_at_work(runner.output());
  std::vector<BatchShot> shots = shots_in_folder(request.folder);
  if (!request.table.empty()) read_shot_table(request.table, shots);
  std::vector<std::string> lines;
  for (const BatchShot& shot : shots) {
    runner.described(shot);  // throws for what cannot be
    lines.push_back(to_line(shot));
  }
  make_shots_folder(runner, request.folder);
  for (const BatchShot& shot : shots) {
    if (output.resume) break;
    fs::remove_all(runner.done(shot));  // of another run: this one is to replace it
    fs::remove_all(runner.aside(shot));
  }
  SettingWriter settings;
  visit_batch(settings, request);
  visit_session(settings, session.options());
  begin_results(runner.output(), "batch", settings, true);
  return lines;
}

std::string share_to_join(const BatchRequest& request) {
  const std::vector<fs::path> shares = shares_in(request.output.folder);
  if (!request.share.name.empty()) {
    for (const fs::path& share : shares) {
      if (share.filename() == request.share.name) return request.share.name;
    }
    throw InvalidArgument("the folder holds no share '" + request.share.name + "'",
                          request.output.folder);
  }
  if (shares.size() == 1) return shares.front().filename().string();
  throw InvalidArgument(
      shares.empty() ? "no processes share this folder" : "several runs were shared in this folder",
      request.output.folder, shares.empty() ? "" : "--share names the one");
}

void require_no_share_at_work(const fs::path& output) {
  const std::vector<fs::path> shares = shares_in(output);
  if (std::all_of(shares.begin(), shares.end(), is_over)) return;
  const fs::path probe = output / kShareFolder / ("now." + member_name());
  std::ofstream(probe) << '\n';
  const fs::file_time_type now = fs::last_write_time(probe);
  fs::remove(probe);
  for (const fs::path& share : shares) {
    if (!is_over(share)) require_silence(share, now);
  }
}

}  // namespace impactdic::run
