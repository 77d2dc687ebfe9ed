#include <impactdic/error.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <exception>
#include <fstream>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "host/app/batch_table.h"
#include "host/app/command.h"
#include "host/app/job.h"
#include "host/app/track_run.h"
#include "host/base/progress.h"
#include "host/report/shots_csv.h"

namespace impactdic::app {
namespace {

namespace fs = std::filesystem;

struct BatchRequest {
  TrackRequest track;  // what all shots have in common
  std::string folder, table;
  int clips = 0;  // in flight; 0: see clips_in_flight
};

constexpr int kMostClips = 4;

// One clip leaves the device idle while its circles are sought and its results are written, and
// the reader while the device is at work: several at a time fill the gaps.
std::size_t clips_in_flight(const BatchRequest& request, std::size_t waiting) {
  const int threads = request.track.common.threads;
  const int cores = threads > 0 ? threads : static_cast<int>(std::thread::hardware_concurrency());
  const int wanted = request.clips > 0 ? request.clips : std::clamp(cores, 1, kMostClips);
  return std::clamp<std::size_t>(waiting, 1, static_cast<std::size_t>(wanted));
}

// Runs every shot as `impactdic track` would be run by hand, several at a time, each on a device
// context of its own. A shot is measured in a folder ending in .part that gets its name when it is
// complete: a run that was killed leaves no half result.
class Batch {
 public:
  Batch(const CLI::App& command, const BatchRequest& request)
      : command_(command), request_(request), shots_(shots_in_folder(request.folder)) {
    if (!request.table.empty()) read_shot_table(request.table, shots_);
    lines_.resize(shots_.size());
    const bool into = request.track.common.force || request.track.resume;
    output_ = prepare_output_directory(request.track.output, into);
    fs::create_directories(shots_folder());
    if (fs::equivalent(shots_folder(), request.folder)) {
      throw InvalidArgument("the results would lie among the clips", request.folder,
                            "name another folder with -o");
    }
    write_job(command, output_ / "job.toml");
  }

  void run() {
    std::vector<std::size_t> waiting;
    for (std::size_t i = 0; i < shots_.size(); ++i) {
      if (request_.track.resume && is_done(shots_[i])) {
        add_to_table(i);
      } else {
        waiting.push_back(i);
      }
    }
    measure_all(waiting);
    write_table();
    report();
  }

 private:
  fs::path shots_folder() const { return output_ / "shots"; }
  fs::path quarantine() const { return output_ / "quarantine"; }
  bool is_done(const BatchShot& shot) const {
    return fs::exists(shots_folder() / shot.name / "summary.json");
  }
  bool quiet() const { return request_.track.common.quiet; }

  void measure_all(const std::vector<std::size_t>& waiting);
  void measure(const BatchShot& shot, RunContext& run);
  std::vector<std::string> track_arguments(const BatchShot& shot, const fs::path& into) const;
  std::string try_shot(const BatchShot& shot, const fs::path& into, RunContext& run);
  void say(std::FILE* stream, const std::string& line);
  void add_to_table(std::size_t index);
  void write_table() const;
  void report() const;

  const CLI::App& command_;
  const BatchRequest& request_;
  std::vector<BatchShot> shots_;
  fs::path output_;
  std::mutex mutex_;                // of what follows, of shots.csv and of the terminal
  std::vector<std::string> lines_;  // of shots.csv; empty: not measured yet
  std::size_t failed_ = 0;
};

void Batch::measure_all(const std::vector<std::size_t>& waiting) {
  if (waiting.empty()) return;
  std::vector<std::unique_ptr<RunContext>> contexts(clips_in_flight(request_, waiting.size()));
  for (auto& context : contexts) {
    context = std::make_unique<RunContext>(request_.track.common, !request_.track.no_field);
  }
  TerminalProgress progress("shots", quiet());
  std::atomic<std::size_t> next = 0, done = 0;
  std::exception_ptr failure;
  const auto work = [&](RunContext& context) {
    try {
      for (std::size_t i = next++; i < waiting.size(); i = next++) {
        measure(shots_[waiting[i]], context);
        const std::lock_guard<std::mutex> lock(mutex_);
        add_to_table(waiting[i]);
        write_table();
        progress(static_cast<std::int64_t>(++done), static_cast<std::int64_t>(waiting.size()));
      }
    } catch (...) {  // no further shot is begun
      next = waiting.size();
      const std::lock_guard<std::mutex> lock(mutex_);
      if (!failure) failure = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> workers;
    for (auto& context : contexts) workers.emplace_back(work, std::ref(*context));
  }
  if (failure) std::rethrow_exception(failure);
}

void Batch::say(std::FILE* stream, const std::string& line) {
  if (quiet()) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  std::fprintf(stream, "%s\n", line.c_str());
  std::fflush(stream);
}

// The options of the batch that `track` has too, with the shot's own put over them.
std::vector<std::string> Batch::track_arguments(const BatchShot& shot, const fs::path& into) const {
  std::vector<std::string> arguments = {shot.clip.string(), "--output=" + into.string()};
  const bool own_angle = !shot.surface_angle_deg.empty();
  if (own_angle) arguments.push_back("--surface-angle-deg=" + shot.surface_angle_deg);
  for (const CLI::Option* option : command_.get_options()) {
    if (option->count() == 0 || option->get_lnames().empty()) continue;
    const std::string& name = option->get_lnames().front();
    if (name == "output" || name == "table" || name == "job" || name == "resume" ||
        name == "clips") {
      continue;
    }
    if (own_angle && name == "surface-angle-deg") continue;
    if (option->get_expected_max() == 0) {
      arguments.insert(arguments.end(), option->count(), "--" + name);
    } else {
      for (const std::string& value : option->results()) {
        arguments.push_back("--" + name + "=" + value);
      }
    }
  }
  return arguments;
}

// Empty, or the reason why there is no result.
std::string Batch::try_shot(const BatchShot& shot, const fs::path& into, RunContext& run) {
  try {
    CLI::App track("", "track");
    TrackRequest request;
    add_track_options(track, request);
    std::vector<std::string> arguments = track_arguments(shot, into);
    std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
    track.parse(arguments);
    request.common.quiet = true;  // the batch speaks for its shots
    fs::create_directories(into);
    const TrackOutcome outcome = track_to_folder(track, request, run);
    if (outcome.frames_ok == 0) return "no ball was measured in any frame";
    say(stdout, shot.name + ": " + std::to_string(outcome.frames_ok) + " of " +
                    std::to_string(outcome.frames) + " frames ok; " + outcome.impact);
    return "";
  } catch (const OpenClError&) {
    throw;  // the device fails for every shot
  } catch (const Error& error) {
    return error.line();
  } catch (const CLI::ParseError& error) {
    return error.what();
  } catch (const std::exception& error) {
    return error.what();
  }
}

void Batch::measure(const BatchShot& shot, RunContext& run) {
  const fs::path part = shots_folder() / (shot.name + ".part");
  const fs::path aside = quarantine() / shot.name;
  fs::remove_all(part);
  fs::remove_all(aside);
  if (is_done(shot)) fs::remove_all(shots_folder() / shot.name);
  const std::string reason = try_shot(shot, part, run);
  if (reason.empty()) {
    fs::rename(part, shots_folder() / shot.name);
    return;
  }
  fs::create_directories(aside);
  if (fs::exists(part)) {
    fs::remove_all(aside);
    fs::rename(part, aside);
  }
  std::ofstream file(aside / "reason.txt");
  file << reason << '\n' << std::flush;
  if (!file) throw FileError("cannot write the file", (aside / "reason.txt").string());
  say(stderr, "impactdic: warning: " + shot.name + ": " + reason);
}

void Batch::add_to_table(std::size_t index) {
  const BatchShot& shot = shots_[index];
  report::ShotEntry entry;
  entry.file = shot.clip.filename().string();
  entry.name = shot.name;
  entry.drop_height_mm = shot.drop_height_mm;
  entry.notes = shot.notes;
  nlohmann::json summary = nlohmann::json::object();
  const fs::path result = shots_folder() / shot.name / "summary.json";
  entry.done = is_done(shot);
  if (entry.done) {
    std::ifstream file(result);
    summary = nlohmann::json::parse(file, nullptr, false);
    if (summary.is_discarded()) {
      throw FormatError(result.string(), -1, "the summary is damaged",
                        "delete the shot's folder, --resume measures it again");
    }
  } else {
    std::ifstream file(quarantine() / shot.name / "reason.txt");
    std::getline(file, entry.reason);
    ++failed_;
  }
  lines_[index] = report::shots_csv_line(entry, summary);
}

void Batch::write_table() const {
  std::vector<std::string> known;
  std::copy_if(lines_.begin(), lines_.end(), std::back_inserter(known),
               [](const std::string& line) { return !line.empty(); });
  report::write_shots_csv(output_ / "shots.csv", known);
}

void Batch::report() const {
  std::size_t unlisted = 0;
  for (const BatchShot& shot : shots_) unlisted += !shot.listed;
  if (!request_.table.empty() && unlisted > 0 && !quiet()) {
    std::fprintf(stderr, "impactdic: warning: %zu clips do not stand in %s\n", unlisted,
                 request_.table.c_str());
  }
  if (failed_ == shots_.size()) {
    throw Error("none of the shots could be measured", request_.folder,
                "the reasons stand in " + (output_ / "shots.csv").string());
  }
  if (failed_ > 0) {
    std::fprintf(stderr, "impactdic: warning: %zu of %zu shots failed; reasons in %s and in %s\n",
                 failed_, shots_.size(), (output_ / "shots.csv").c_str(), quarantine().c_str());
  }
  if (!quiet()) {
    std::printf("%zu of %zu shots measured; table in %s\n", shots_.size() - failed_, shots_.size(),
                (output_ / "shots.csv").c_str());
  }
}

}  // namespace

void add_batch_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("batch", "track for every clip of a folder, and one table");
  auto request = std::make_shared<BatchRequest>();
  command->add_option("folder", request->folder, "Folder of clips, or of folders of pictures")
      ->required();
  command->add_option("-o,--output", request->track.output, "Folder for the results")->required();
  command->add_option("--table", request->table,
                      "CSV with a row a shot: file, surface_angle_deg, drop_height_mm, notes");
  command->add_flag("--resume", request->track.resume,
                    "Keep the shots that an earlier run measured; try the others");
  command
      ->add_option("--clips", request->clips,
                   "Clips measured at a time; 0: as many as threads, up to 4")
      ->check(CLI::Range(0, 64))
      ->capture_default_str();
  add_reading_options(*command, request->track.video);
  add_track_settings(*command, request->track);
  add_common_options(*command, request->track.common);
  command->footer(
      "Writes shots/NAME/ with what track writes of each clip, quarantine/NAME/reason.txt of "
      "those\n"
      "that failed, and shots.csv with a row for each; impactdic report makes one page of all.\n"
      "Example:\n"
      "  impactdic batch shots -o results --table shots.csv --fps 10000 --ball-diameter-mm 67\n");
  command->callback([command, request] {
    check_settings(request->track);
    Batch(*command, *request).run();
  });
}

}  // namespace impactdic::app
