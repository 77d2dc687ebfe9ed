#include "host/view/track_job.h"

#include <impactdic/error.h>

#include <nlohmann/json.hpp>
#include <set>

#include "host/cli/quantity.h"
#include "host/run/settings/job_file.h"
#include "host/run/settings/setting_texts.h"
#include "host/run/settings/settings.h"

namespace impactdic::view {
namespace {

using Json = nlohmann::json;

struct KeyCollector {
  std::set<std::string>& keys;
  template <typename T>
  void operator()(const run::Setting& setting, const T&) {
    keys.insert(setting.key);
  }
};

// The reading of the clip counts too: its rate can be set.
template <typename Visitor, typename Job>
void visit_settings(Visitor&& visit, Job& job) {
  visit(run::Setting{"fps", run::kZeroUnset}, job.request.clip.fps);
  run::visit_track_settings(visit, job.request, job.folder);
}

run::SettingValue value_of_json(const Json& value, const std::string& key) {
  if (value.is_boolean()) return value.get<bool>();
  if (value.is_number_integer()) return value.get<std::int64_t>();
  if (value.is_number()) return value.get<double>();
  if (value.is_string()) {  // with a unit, as on the command line
    const std::string text = value.get<std::string>();
    return cli::in_unit(text, cli::unit_of(key)).value_or(text);
  }
  throw InvalidArgument("the value must be a text, a number, true or false", "--" + key);
}

Json json_of(const run::SettingValue& value) {
  if (const auto* flag = std::get_if<bool>(&value)) return *flag;
  return run::to_text(value);
}

class Describer {
 public:
  template <typename T>
  void operator()(const run::Setting& setting, const T& member) {
    Json entry = {{"key", setting.key}};
    const auto help = run::setting_texts().find(setting.key);
    entry["help"] = help == run::setting_texts().end() ? std::string() : help->second;
    const std::string text = run::to_text(run::value_of(member));
    const bool unset = (setting.kind & run::kZeroUnset) != 0 && text == "0";
    entry["default"] = unset ? std::string() : text;
    entry["kind"] = "text";
    if constexpr (std::is_same_v<T, bool>) {
      entry["kind"] = "flag";
      entry["default"] = false;
    } else if constexpr (std::is_arithmetic_v<T>) {
      entry["kind"] = "number";
    } else if constexpr (std::is_same_v<T, Estimator>) {
      entry["choices"] = {"ball", "field", "ring"};
    } else if constexpr (std::is_same_v<T, Body>) {
      entry["choices"] = {"auto", "sphere", "disc"};
    } else if constexpr (std::is_same_v<T, FieldMethod>) {
      entry["choices"] = {"icgn", "zncc", "equal", "published"};
    }
    list_.push_back(std::move(entry));
  }
  Json take() { return std::move(list_); }

 private:
  Json list_ = Json::array();
};

// A word that a shell takes as it stands, else in single quotes.
std::string quoted(const std::string& word) {
  constexpr char kPlain[] =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+./:,=%@";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

}  // namespace

TrackJob read_job(const Json& settings, const ClipRequest& clip) {
  if (!settings.is_object()) throw InvalidArgument("settings must be an object", "settings");
  TrackJob job;
  job.request.clip = clip;
  std::set<std::string> keys;
  visit_settings(KeyCollector{keys}, job);
  run::SettingValues values;
  for (const auto& [key, value] : settings.items()) {
    if (keys.count(key) == 0) throw InvalidArgument("track has no such setting", "--" + key);
    if (value.is_null() || value == "") continue;
    values[key] = value_of_json(value, key);
  }
  visit_settings(run::SettingReader(values, "settings"), job);
  job.request.validate();
  return job;
}

run::SettingValues given_settings(const TrackJob& job) {
  run::SettingWriter given, defaults;
  visit_settings(given, job);
  const TrackJob plain;
  visit_settings(defaults, plain);
  run::SettingValues values = given.values();
  for (const auto& [key, value] : defaults.values()) {
    const auto same = values.find(key);
    if (same != values.end() && run::to_text(same->second) == run::to_text(value)) {
      values.erase(same);
    }
  }
  return values;
}

std::string command_line(const TrackJob& job) {
  std::string line = "impactdic track";
  for (const std::string& path : job.request.clip.paths) line += " " + quoted(path);
  if (job.request.clip.open.raw) {
    line += " --raw " + run::to_text(run::value_of(job.request.clip.open.raw));
  }
  line += " -o " + quoted(job.folder.folder);
  for (const auto& [key, value] : given_settings(job)) {
    line += " --" + key;
    if (!std::holds_alternative<bool>(value)) line += " " + quoted(run::to_text(value));
  }
  return line;
}

Json describe_settings() {
  Describer describe;
  const TrackJob plain;
  visit_settings(describe, plain);
  return describe.take();
}

Json settings_of_results(const std::filesystem::path& folder) {
  Json settings = Json::object();
  if (folder.empty() || !std::filesystem::is_regular_file(folder / "job.toml")) return settings;
  const run::SettingValues values = run::read_job_file(folder / "job.toml");
  const auto command = values.find("command");
  if (command == values.end() || run::to_text(command->second) != "track") return settings;
  TrackJob job;
  visit_settings(run::SettingReader(values, (folder / "job.toml").string()), job);
  for (const auto& [key, value] : given_settings(job)) settings[key] = json_of(value);
  return settings;
}

}  // namespace impactdic::view
