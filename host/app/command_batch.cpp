#include <algorithm>
#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/app/batch_table.h"
#include "host/app/command.h"
#include "host/app/job.h"
#include "host/app/track_run.h"
#include "host/base/error.h"
#include "host/report/shots_csv.h"

namespace impactdic::app {
namespace {

namespace fs = std::filesystem;

struct BatchRequest {
  TrackRequest track;  // what all shots have in common
  std::string folder, table;
};

// Runs every shot as `impactdic track` would be run by hand. A shot is measured in a folder ending
// in .part that gets its name when it is complete: a run that was killed leaves no half result.
class Batch {
 public:
  Batch(const CLI::App& command, const BatchRequest& request)
      : command_(command),
        request_(request),
        shots_(shots_in_folder(request.folder)),
        run_(request.track.common, !request.track.no_field) {
    if (!request.table.empty()) read_shot_table(request.table, shots_);
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
    for (const BatchShot& shot : shots_) {
      if (!request_.track.resume || !is_done(shot)) measure(shot);
      add_to_table(shot);
      write_shots_csv(output_ / "shots.csv", lines_);
    }
    report();
  }

 private:
  fs::path shots_folder() const { return output_ / "shots"; }
  fs::path quarantine() const { return output_ / "quarantine"; }
  bool is_done(const BatchShot& shot) const {
    return fs::exists(shots_folder() / shot.name / "summary.json");
  }
  bool quiet() const { return request_.track.common.quiet; }

  void measure(const BatchShot& shot);
  std::vector<std::string> track_arguments(const BatchShot& shot, const fs::path& into) const;
  std::string try_shot(const BatchShot& shot, const fs::path& into);
  void add_to_table(const BatchShot& shot);
  void report() const;

  const CLI::App& command_;
  const BatchRequest& request_;
  std::vector<BatchShot> shots_;
  RunContext run_;
  fs::path output_;
  std::vector<std::string> lines_;
  std::size_t failed_ = 0;
};

// The options of the batch that `track` has too, with the shot's own put over them.
std::vector<std::string> Batch::track_arguments(const BatchShot& shot, const fs::path& into) const {
  std::vector<std::string> arguments = {shot.clip.string(), "--output=" + into.string()};
  const bool own_angle = !shot.surface_angle_deg.empty();
  if (own_angle) arguments.push_back("--surface-angle-deg=" + shot.surface_angle_deg);
  for (const CLI::Option* option : command_.get_options()) {
    if (option->count() == 0 || option->get_lnames().empty()) continue;
    const std::string& name = option->get_lnames().front();
    if (name == "output" || name == "table" || name == "job" || name == "resume") continue;
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
std::string Batch::try_shot(const BatchShot& shot, const fs::path& into) {
  try {
    CLI::App track("", "track");
    TrackRequest request;
    add_track_options(track, request);
    std::vector<std::string> arguments = track_arguments(shot, into);
    std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
    track.parse(arguments);
    fs::create_directories(into);
    const TrackOutcome outcome = track_to_folder(track, request, run_);
    if (outcome.frames_ok == 0) return "no ball was measured in any frame";
    if (!quiet()) {
      std::printf("%s: %lld of %lld frames ok; %s\n", shot.name.c_str(),
                  static_cast<long long>(outcome.frames_ok), static_cast<long long>(outcome.frames),
                  outcome.impact.c_str());
      std::fflush(stdout);
    }
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

void Batch::measure(const BatchShot& shot) {
  const fs::path part = shots_folder() / (shot.name + ".part");
  const fs::path aside = quarantine() / shot.name;
  fs::remove_all(part);
  fs::remove_all(aside);
  if (is_done(shot)) fs::remove_all(shots_folder() / shot.name);
  const std::string reason = try_shot(shot, part);
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
  if (!quiet())
    std::fprintf(stderr, "impactdic: warning: %s: %s\n", shot.name.c_str(), reason.c_str());
}

void Batch::add_to_table(const BatchShot& shot) {
  ShotEntry entry;
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
  lines_.push_back(shots_csv_line(entry, summary));
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
  add_reading_options(*command, request->track.video);
  add_track_settings(*command, request->track);
  add_common_options(*command, request->track.common);
  command->footer(
      "Writes shots/NAME/ with what track writes of each clip, quarantine/NAME/reason.txt of "
      "those\n"
      "that failed, and shots.csv with a row for each.\nExample:\n"
      "  impactdic batch shots -o results --table shots.csv --fps 10000 --ball-diameter-mm 67\n");
  command->callback([command, request] { Batch(*command, *request).run(); });
}

}  // namespace impactdic::app
