// `track` for every clip of a folder; see api/impactdic/batch.h.
#include <impactdic/batch.h>
#include <impactdic/error.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <optional>
#include <thread>

#include "host/report/shots_csv.h"
#include "host/report/words.h"
#include "host/run/batch_table.h"
#include "host/run/control.h"
#include "host/run/folder.h"
#include "host/run/results/result_digests.h"
#include "host/run/settings/job_file.h"

namespace impactdic {
namespace {

namespace fs = std::filesystem;

constexpr int kMostClips = 4;

// One clip leaves the device idle while its circles are sought and its results are written, and
// the reader while the device is at work: several at a time fill the gaps.
std::size_t clips_in_flight(int asked, int threads, std::size_t waiting) {
  const int cores = threads > 0 ? threads : static_cast<int>(std::thread::hardware_concurrency());
  const int wanted = asked > 0 ? asked : std::clamp(cores, 1, kMostClips);
  return std::clamp<std::size_t>(waiting, 1, static_cast<std::size_t>(wanted));
}

class Batch {
 public:
  Batch(const BatchRequest& request, Session& session, run::Caller& caller);
  BatchResult run();

 private:
  fs::path shots_folder() const { return output_ / "shots"; }
  fs::path part_of(const run::BatchShot& shot) const {
    return shots_folder() / (shot.name + ".part");
  }
  fs::path quarantine() const { return output_ / "quarantine"; }
  bool is_done(const run::BatchShot& shot) const {
    return fs::exists(shots_folder() / shot.name / "summary.json");
  }
  // What `shot` asks of `track` and where its results go.
  TrackRequest request_of(const run::BatchShot& shot) const;
  TrackFolder folder_of(const fs::path& into) const;
  // With --resume: whether what an earlier run made of the shot is what this one would. Throws
  // InvalidArgument where that would have to be measured otherwise.
  bool is_settled(const run::BatchShot& shot) const;
  void measure_all(const std::vector<std::size_t>& waiting);
  void measure(std::size_t index);
  // Empty, or the reason why there is no result.
  std::string try_shot(const run::BatchShot& shot, const fs::path& into, ShotResult& result);
  void warn_of_contradictions(const ShotResult& shot) {
    for (const Contradiction& found : shot.impact.contradictions) {
      caller_.say(MessageKind::kWarning, shot.name + ": " + found.message);
    }
  }
  void put_aside(const run::BatchShot& shot, const fs::path& part, const std::string& reason);
  void note(std::size_t index, ShotResult shot);
  void write_table() const;
  void conclude();

  const BatchRequest& request_;
  Session& session_;
  run::Caller& caller_;
  std::vector<run::BatchShot> shots_;
  std::optional<run::OutputFolder> held_;
  fs::path output_;
  std::mutex mutex_;                // of what follows and of shots.csv
  std::vector<std::string> lines_;  // of shots.csv; empty: not measured yet
  BatchResult result_;
};

Batch::Batch(const BatchRequest& request, Session& session, run::Caller& caller)
    : request_(request),
      session_(session),
      caller_(caller),
      shots_(run::shots_in_folder(request.folder)) {
  if (!request.table.empty()) run::read_shot_table(request.table, shots_);
  lines_.resize(shots_.size());
  const TrackFolder& output = request.output;
  held_.emplace(output.folder, output.force || output.resume);
  output_ = held_->path();
  fs::create_directories(shots_folder());
  if (fs::equivalent(shots_folder(), request.folder)) {
    throw InvalidArgument("the results would lie among the clips", request.folder,
                          "name another folder with -o");
  }
  run::SettingWriter settings;
  run::visit_batch(settings, request);
  run::visit_session(settings, session.options());
  run::begin_results(output_, "batch", settings, true);
  result_.table = (output_ / "shots.csv").string();
  for (const run::BatchShot& shot : shots_) {
    ShotResult& entry = result_.shots.emplace_back();
    entry.file = shot.clip.filename().string();
    entry.name = shot.name;
    entry.listed = shot.listed;
    entry.drop_height_mm = shot.drop_height_mm;
    entry.notes = shot.notes;
    entry.ball = shot.ball;
    entry.mass_g = shot.mass_g;
    const TrackRequest of_it = request_of(shot);
    of_it.validate();
    if (of_it.ball_diameter_mm > 0) entry.ball_diameter_mm = of_it.ball_diameter_mm;
    if (of_it.inertia_factor > 0) entry.inertia_factor = of_it.inertia_factor;
  }
}

BatchResult Batch::run() {
  std::vector<std::size_t> waiting;
  for (std::size_t i = 0; i < shots_.size(); ++i) {
    if (request_.output.resume && is_settled(shots_[i])) {
      ShotResult shot = result_.shots[i];
      shot.done = true;
      report::read_shot(shot, shots_folder() / shots_[i].name / "summary.json");
      warn_of_contradictions(shot);
      note(i, std::move(shot));
    } else {
      waiting.push_back(i);
    }
  }
  if (!waiting.empty()) measure_all(waiting);
  write_table();
  if (request_.output.checksum) run::write_digests(output_);
  conclude();
  return std::move(result_);
}

void Batch::measure_all(const std::vector<std::size_t>& waiting) {
  if (request_.track.with_field) session_.open();
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
        clips_in_flight(request_.clips, session_.options().threads, waiting.size());
    for (std::size_t k = 0; k < count; ++k) workers.emplace_back(work);
  }
  if (failure) std::rethrow_exception(failure);
}

TrackRequest Batch::request_of(const run::BatchShot& shot) const {
  TrackRequest request = request_.track;
  request.clip.source = nullptr;
  request.clip.paths = {shot.clip.string()};
  if (shot.surface_angle_deg) request.surface_angle_deg = *shot.surface_angle_deg;
  if (shot.ball_diameter_mm) {
    request.ball_diameter_mm = *shot.ball_diameter_mm;
    request.mm_per_px = request.mm_per_px_sd = 0;  // the shot's own scale
  }
  if (shot.inertia_factor) request.inertia_factor = *shot.inertia_factor;
  if (shot.height_mm) request.drop_height_mm = *shot.height_mm;
  return request;
}

TrackFolder Batch::folder_of(const fs::path& into) const {
  TrackFolder folder = request_.output;
  folder.folder = into.string();
  folder.force = true;
  return folder;
}

bool Batch::is_settled(const run::BatchShot& shot) const {
  const TrackRequest request = request_of(shot);
  const TrackFolder folder = folder_of(part_of(shot));
  run::SettingWriter settings;
  run::visit_track(settings, request, folder);
  run::visit_session(settings, session_.options());
  const fs::path done = shots_folder() / shot.name;
  for (const fs::path& earlier : {done, part_of(shot)}) {
    if (fs::exists(earlier / "job.toml")) run::require_same_job(earlier / "job.toml", settings);
  }
  return is_done(shot) && run::same_afterwards(done / "job.toml", settings);
}

std::string Batch::try_shot(const run::BatchShot& shot, const fs::path& into, ShotResult& result) {
  const TrackRequest request = request_of(shot);
  const TrackFolder folder = folder_of(into);
  // The batch speaks for its shots.
  RunControl control;
  control.cancelled = [this] { return caller_.cancelled(); };
  control.message = [this](const Message& message) {
    if (message.kind == MessageKind::kTiming) caller_.say(message.kind, message.text);
  };
  try {
    fs::create_directories(into);
    const TrackResult measured = track_to_folder(request, folder, session_, control);
    if (measured.cancelled) return "the run was cancelled";
    if (measured.frames_ok == 0) return "no ball was measured in any frame";
    report::fill_shot(result, measured);
    result.done = result.measured_now = true;
    caller_.say(MessageKind::kNote, shot.name + ": " + std::to_string(measured.frames_ok) + " of " +
                                        std::to_string(measured.frames.count()) + " frames ok; " +
                                        report::in_words(measured.impact_si));
    warn_of_contradictions(result);
    return "";
  } catch (const OpenClError&) {
    throw;  // the device fails for every shot
  } catch (const Error& error) {
    return error.line();
  } catch (const std::exception& error) {
    return error.what();
  }
}

void Batch::measure(std::size_t index) {
  const run::BatchShot& shot = shots_[index];
  const fs::path part = part_of(shot), done = shots_folder() / shot.name;
  fs::remove_all(quarantine() / shot.name);
  if (request_.output.resume) {
    // What an earlier run measured is gone on with.
    if (fs::exists(done) && !fs::exists(part)) fs::rename(done, part);
  } else {
    fs::remove_all(part);
  }
  fs::remove_all(done);
  ShotResult result = result_.shots[index];
  result.reason = try_shot(shot, part, result);
  if (result.done) {
    fs::rename(part, done);
  } else if (!caller_.cancelled()) {
    put_aside(shot, part, result.reason);
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  note(index, std::move(result));
  write_table();
}

void Batch::put_aside(const run::BatchShot& shot, const fs::path& part, const std::string& reason) {
  const fs::path aside = quarantine() / shot.name;
  fs::create_directories(aside);
  if (fs::exists(part)) {
    fs::remove_all(aside);
    fs::rename(part, aside);
  }
  std::ofstream file(aside / "reason.txt");
  file << reason << '\n' << std::flush;
  if (!file) throw FileError("cannot write the file", (aside / "reason.txt").string());
  caller_.say(MessageKind::kWarning, shot.name + ": " + reason);
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
  report::write_shots_csv(output_ / "shots.csv", known);
}

void Batch::conclude() {
  const auto warn = [&](const std::string& warning) {
    result_.warnings.push_back(warning);
    caller_.say(MessageKind::kWarning, warning);
  };
  const auto unlisted = std::count_if(shots_.begin(), shots_.end(),
                                      [](const run::BatchShot& shot) { return !shot.listed; });
  if (!request_.table.empty() && unlisted > 0) {
    warn(std::to_string(unlisted) + " clips do not stand in " + request_.table);
  }
  result_.cancelled =
      caller_.cancelled() && std::any_of(result_.shots.begin(), result_.shots.end(),
                                         [](const ShotResult& shot) { return !shot.done; });
  if (!result_.cancelled && result_.failed == shots_.size()) {
    throw Error("none of the shots could be measured", request_.folder,
                "the reasons stand in " + result_.table);
  }
  if (result_.failed > 0) {
    warn(std::to_string(result_.failed) + " of " + std::to_string(shots_.size()) +
         " shots failed; reasons in " + result_.table + " and in " + quarantine().string());
  }
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
}

BatchResult batch(const BatchRequest& request, Session& session, const RunControl& control) {
  request.validate();
  run::Caller caller(control);
  return Batch(request, session, caller).run();
}

}  // namespace impactdic
