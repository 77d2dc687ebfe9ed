// `track` for every clip of a folder; see api/impactdic/batch.h.
#include <impactdic/batch.h>
#include <impactdic/error.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <filesystem>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>

#include "host/report/shots_csv.h"
#include "host/run/batch/conclude.h"
#include "host/run/batch/share_folder.h"
#include "host/run/batch/shared_batch.h"
#include "host/run/batch/shot_runner.h"
#include "host/run/batch_table.h"
#include "host/run/control.h"
#include "host/run/expected_programs.h"
#include "host/run/folder.h"
#include "host/run/results/result_digests.h"
#include "host/run/settings/job_file.h"

namespace impactdic {
namespace {

namespace fs = std::filesystem;

class Batch {
 public:
  Batch(const BatchRequest& request, Session& session, run::Caller& caller);
  BatchResult run();

 private:
  fs::path part_of(const run::BatchShot& shot) const {
    return runner_.shots() / (shot.name + ".part");
  }
  void measure_all(const std::vector<std::size_t>& waiting);
  void measure(std::size_t index);
  void require_device(const fs::path& part) const;
  void note(std::size_t index, ShotResult shot);
  void write_table() const;

  const BatchRequest& request_;
  Session& session_;
  run::Caller& caller_;
  run::ShotRunner runner_;
  std::vector<run::BatchShot> shots_;
  std::optional<run::OutputFolder> held_;
  std::mutex mutex_;                // of what follows and of shots.csv
  std::vector<std::string> lines_;  // of shots.csv; empty: not measured yet
  BatchResult result_;
};

Batch::Batch(const BatchRequest& request, Session& session, run::Caller& caller)
    : request_(request),
      session_(session),
      caller_(caller),
      runner_(request, session, caller),
      shots_(run::shots_in_folder(request.folder)) {
  if (!request.table.empty()) run::read_shot_table(request.table, shots_);
  lines_.resize(shots_.size());
  const TrackFolder& output = request.output;
  held_.emplace(output.folder, output.force || output.resume);
  run::require_no_share_at_work(runner_.output());
  run::make_shots_folder(runner_, request.folder);
  run::SettingWriter settings;
  run::visit_batch(settings, request);
  run::visit_session(settings, session.options());
  run::begin_results(runner_.output(), "batch", settings, true);
  result_.table = (runner_.output() / "shots.csv").string();
  for (const run::BatchShot& shot : shots_) result_.shots.push_back(runner_.described(shot));
}

BatchResult Batch::run() {
  std::vector<std::size_t> waiting;
  for (std::size_t i = 0; i < shots_.size(); ++i) {
    if (request_.output.resume && runner_.is_settled(shots_[i], part_of(shots_[i]))) {
      ShotResult shot = runner_.read_done(shots_[i]);
      runner_.warn_of_contradictions(shot);
      note(i, std::move(shot));
    } else {
      waiting.push_back(i);
    }
  }
  if (!waiting.empty()) measure_all(waiting);
  write_table();
  if (request_.output.checksum) run::write_digests(runner_.output());
  result_.cancelled =
      caller_.cancelled() && std::any_of(result_.shots.begin(), result_.shots.end(),
                                         [](const ShotResult& shot) { return !shot.done; });
  run::conclude_batch(request_, caller_, result_);
  return std::move(result_);
}

void Batch::measure_all(const std::vector<std::size_t>& waiting) {
  // Beside the looks at the first shots; who needs a device waits for it.
  if (request_.track.with_field) {
    session_.impl().open_beside(run::expected_programs(request_.track));
  }
  std::atomic<std::size_t> next = 0, done = 0;
  std::exception_ptr failure;
  const auto work = [&] {
    try {
      for (std::size_t i = next++; i < waiting.size() && !caller_.cancelled(); i = next++) {
        measure(waiting[i]);
        caller_.progress("shots", static_cast<std::int64_t>(++done),
                         static_cast<std::int64_t>(waiting.size()));
      }
    } catch (...) {  // no further shot is begun
      next = waiting.size();
      const std::lock_guard<std::mutex> lock(mutex_);
      if (!failure) failure = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> workers;
    const std::size_t count =
        run::clips_in_flight(request_.clips, session_.options().threads, waiting.size());
    for (std::size_t k = 0; k < count; ++k) workers.emplace_back(work);
  }
  if (failure) std::rethrow_exception(failure);
}

void Batch::measure(std::size_t index) {
  const run::BatchShot& shot = shots_[index];
  const fs::path part = part_of(shot), done = runner_.done(shot);
  fs::remove_all(runner_.aside(shot));
  if (request_.output.resume) {
    // What an earlier run measured is gone on with.
    if (fs::exists(done) && !fs::exists(part)) fs::rename(done, part);
  } else {
    fs::remove_all(part);
  }
  fs::remove_all(done);
  ShotResult result = result_.shots[index];
  result.reason = runner_.measure(shot, part, result);
  if (!result.done) require_device(part);
  if (result.done) {
    fs::rename(part, done);
  } else if (!caller_.cancelled()) {
    runner_.put_aside(shot, part, result.reason);
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  note(index, std::move(result));
  write_table();
}

// Throws where there is none: the shot is not to blame, and leaves no folder with nothing in it.
void Batch::require_device(const fs::path& part) const {
  if (!request_.track.with_field) return;
  try {
    session_.impl().open_engines();
  } catch (...) {
    std::error_code holds_something;
    fs::remove(part, holds_something);
    throw;
  }
}

void Batch::note(std::size_t index, ShotResult shot) {
  result_.failed += !shot.done;
  lines_[index] = report::shots_csv_line(shot);
  result_.shots[index] = std::move(shot);
}

void Batch::write_table() const {
  std::vector<std::string> known;
  std::copy_if(lines_.begin(), lines_.end(), std::back_inserter(known),
               [](const std::string& line) { return !line.empty(); });
  report::write_shots_csv(runner_.output() / "shots.csv", known);
}

}  // namespace

void BatchRequest::validate() const {
  TrackRequest of_a_shot = track;
  of_a_shot.clip.source = nullptr;
  of_a_shot.clip.paths = {folder};
  of_a_shot.validate();
  output.validate();
  if (folder.empty()) throw InvalidArgument("no folder of clips is named", "folder");
  if (clips < 0 || clips > 64) {
    throw InvalidArgument("the clips must be between 0 and 64, not " + std::to_string(clips),
                          "--clips");
  }
  run::check_share(*this);
}

BatchResult batch(const BatchRequest& request, Session& session, const RunControl& control) {
  request.validate();
  run::Caller caller(control);
  if (request.share.join) return run::join_shared_batch(request, session, caller);
  if (!request.share.name.empty()) return run::shared_batch(request, session, caller);
  return Batch(request, session, caller).run();
}

}  // namespace impactdic
