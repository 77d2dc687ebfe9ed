#include "host/view/target.h"

#include <impactdic/error.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host/base/csv_table.h"
#include "host/run/open_clip.h"
#include "host/run/settings/job_file.h"
#include "host/view/page_request.h"

namespace impactdic::view {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kOpenShots = 4;  // of a batch at a time

bool holds(const fs::path& folder, const char* name) { return fs::is_regular_file(folder / name); }

std::shared_ptr<Shot> shot_of_results(const fs::path& folder, const fs::path& residuals = {}) {
  return std::make_shared<Shot>(clip_of_results(folder), folder, residuals);
}

// Text for a cell: neither divides it, nor is it taken for a formula.
std::string as_cell(std::string text) {
  for (char& c : text) {
    if (c == ',') c = ';';
    if (c == '"') c = '\'';
    if (static_cast<unsigned char>(c) < 32) c = ' ';
  }
  const bool formula = !text.empty() && std::string("=+-@").find(text[0]) != std::string::npos;
  return formula ? "'" + text : text;
}

std::map<std::string, std::string> read_excluded(const fs::path& file) {
  std::map<std::string, std::string> reasons;
  if (!fs::is_regular_file(file)) return reasons;
  const CsvTable table = CsvTable::read(file);
  const std::vector<std::string> shots = table.text("shot"), why = table.text("reason");
  for (std::size_t i = 0; i < shots.size(); ++i) reasons[shots[i]] = why[i];
  return reasons;
}

// The shots of a batch that have a folder of results. A name that leads elsewhere is none.
std::vector<std::string> shots_of(const fs::path& batch) {
  std::vector<std::string> names;
  for (const std::string& name : CsvTable::read(batch / "shots.csv").text("shot")) {
    const fs::path path(name);
    if (name.empty() || path != path.filename() || name == "." || name == "..") continue;
    if (holds(batch / "shots" / path, "job.toml")) names.push_back(name);
  }
  return names;
}

}  // namespace

ClipRequest clip_of_results(const fs::path& folder) {
  ClipRequest clip;
  const run::SettingValues job = run::read_job_file(folder / "job.toml");
  run::visit_clip(run::SettingReader(job, (folder / "job.toml").string()), clip);
  return clip;
}

Target::Target(const ClipRequest& clip) {
  clip.validate();
  const fs::path first = fs::absolute(clip.paths.front()).lexically_normal();
  const fs::path folder = first.has_filename() ? first : first.parent_path();
  title_ = folder.filename().string();
  const bool alone = clip.paths.size() == 1 && fs::is_directory(folder);
  if (alone && holds(folder, "shots.csv")) {
    batch_ = folder;
    shots_ = shots_of(batch_);
  } else if (alone && holds(folder, "parameters.csv") && holds(folder, "summary.json")) {
    read_fit(folder);
  } else if (alone && holds(folder, "job.toml")) {
    open_[""] = shot_of_results(folder);
  } else {
    run::open_requested(clip);  // for its error
    open_[""] = std::make_shared<Shot>(clip, "");
    if (!open_[""]->source()) throw FileError(open_[""]->clip_error());
  }
}

void Target::read_fit(const fs::path& folder) {
  std::ifstream file(folder / "summary.json");
  const auto summary = nlohmann::json::parse(file, nullptr, false);
  const auto member = [](const nlohmann::json& of, const char* key) {
    return of.is_object() ? of.value(key, nlohmann::json()) : nlohmann::json();
  };
  for (std::size_t k = 0; k < member(summary, "shots").size(); ++k) {
    const nlohmann::json track = member(member(member(summary, "shots")[k], "shot"), "track");
    if (!track.is_string()) continue;
    const fs::path results = fs::path(track.get<std::string>()).parent_path();
    if (!holds(results, "job.toml")) continue;
    std::string name = results.filename().string();
    if (fitted_.count(name) > 0) name += "_" + std::to_string(k + 1);
    fitted_[name] = {results, folder / ("residuals_" + std::to_string(k) + ".csv")};
    shots_.push_back(name);
  }
  if (shots_.empty()) {
    throw InvalidArgument("the results of none of its tracks are here", folder.string());
  }
  const nlohmann::json parameters = member(summary, "parameters");
  if (parameters.is_object()) {
    parameters_ = parameters.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }
}

std::string Target::shots_table() const {
  return batch_.empty() ? std::string() : Shot({}, batch_).text("shots.csv");
}

std::map<std::string, std::string> Target::excluded() const {
  if (batch_.empty()) return {};
  const std::lock_guard<std::mutex> lock(mutex_);
  return read_excluded(batch_ / "excluded.csv");
}

void Target::exclude(const std::string& shot, const std::string& reason) {
  if (batch_.empty()) throw NotThere("there are no shots");
  const std::vector<std::string> all = CsvTable::read(batch_ / "shots.csv").text("shot");
  if (shot.empty() || std::find(all.begin(), all.end(), shot) == all.end()) {
    throw NotThere("there is no such shot");
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  const fs::path path = batch_ / "excluded.csv", part = batch_ / "excluded.csv.part";
  std::map<std::string, std::string> reasons = read_excluded(path);
  reasons.erase(shot);
  if (!reason.empty()) reasons[shot] = as_cell(reason);
  {
    std::ofstream file(part);
    file << "shot,reason\n";
    for (const auto& [name, why] : reasons) file << name << ',' << why << '\n';
    file.flush();
    if (!file) throw FileError("cannot write the file", path.string());
  }
  std::error_code error;
  fs::rename(part, path, error);
  if (error) throw FileError("cannot replace the file: " + error.message(), path.string());
}

std::shared_ptr<Shot> Target::shot(const std::string& name) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (const auto found = open_.find(name); found != open_.end()) return found->second;
  if (std::find(shots_.begin(), shots_.end(), name) == shots_.end()) {
    throw NotThere("there is no such shot");
  }
  if (open_.size() >= kOpenShots) open_.erase(open_.begin());
  const auto fitted = fitted_.find(name);
  return open_[name] = fitted != fitted_.end()
                           ? shot_of_results(fitted->second.results, fitted->second.residuals)
                           : shot_of_results(batch_ / "shots" / name);
}

}  // namespace impactdic::view
