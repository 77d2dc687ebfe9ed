#include "host/view/run_job.h"

#include <impactdic/error.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "host/report/csv.h"

namespace impactdic::view {

using Guard = std::lock_guard<std::mutex>;

RunJob::~RunJob() {
  stop();
  if (thread_.joinable()) thread_.join();
}

void RunJob::start(std::shared_ptr<Shot> shot, const TrackJob& job) {
  job.folder.validate();
  const Guard one_at_a_time(starting_);
  {
    const Guard lock(mutex_);
    if (state_ == "running") throw InvalidArgument("a run is at work", folder_, "stop it first");
    state_ = "running";
    error_.clear();
    folder_ = job.folder.folder;
    done_ = total_ = 0;
    rows_.clear();
    messages_.clear();
  }
  if (thread_.joinable()) thread_.join();
  stop_ = false;
  shot->forget_fields();
  thread_ = std::thread([this, shot = std::move(shot), job] { run(shot, job); });
}

void RunJob::run(const std::shared_ptr<Shot>& shot, const TrackJob& job) {
  RunControl control;
  control.cancelled = [this] { return stop_.load(); };
  control.progress = [this](const Progress& progress) {
    const Guard lock(mutex_);
    done_ = progress.done;
    total_ = progress.total;
  };
  control.message = [this](const Message& message) {
    const Guard lock(mutex_);
    const bool warning = message.kind == MessageKind::kWarning;
    messages_.push_back((warning ? "warning: " : "") + message.text);
  };
  const TrackSink sink = [this](const TrackedFrame& tracked) {
    const Guard lock(mutex_);
    rows_.push_back(report::track_csv_line(tracked.row, SiScale{}));
  };
  try {
    const TrackResult result = track_to_folder(job.request, job.folder, session_, control, sink);
    finish(shot, result.cancelled ? "stopped" : "done");
  } catch (const Error& error) {
    finish(shot, "failed", error.line());
  } catch (const std::exception& error) {
    finish(shot, "failed", error.what());
  }
}

void RunJob::finish(const std::shared_ptr<Shot>& shot, const std::string& state,
                    const std::string& error) {
  // A run that was refused has left the folder to someone else.
  const std::filesystem::path folder = std::filesystem::absolute(folder_);
  if (state != "failed" || !rows_.empty()) shot->set_folder(folder);
  const Guard lock(mutex_);
  state_ = state;
  error_ = error;
  compiling_.clear();
}

nlohmann::json RunJob::status(std::size_t from) const {
  const Guard lock(mutex_);
  const std::size_t first = std::min(from, rows_.size());
  return {{"state", state_},
          {"error", error_},
          {"folder", folder_},
          {"done", done_},
          {"total", total_},
          {"header", report::kTrackCsvHeader},
          {"from", first},
          {"rows", std::vector<std::string>(rows_.begin() + static_cast<std::ptrdiff_t>(first),
                                            rows_.end())},
          {"messages", messages_},
          {"compiling", compiling_}};
}

void RunJob::note_compiling(const CompileProgress& progress) {
  const Guard lock(mutex_);
  compiling_ = progress.done < progress.known
                   ? "compiling kernels, once for this machine: " + std::to_string(progress.done) +
                         " of " + std::to_string(progress.known) + ", " + progress.kernel
                   : "";
}

}  // namespace impactdic::view
