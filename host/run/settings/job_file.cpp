#include "host/run/settings/job_file.h"

#include <impactdic/error.h>
#include <toml++/toml.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>

#include "host/base/parse.h"
#include "host/base/toml_text.h"

namespace impactdic::run {
namespace {

namespace fs = std::filesystem;

SettingValue value_of_node(const toml::node& node, const std::string& where) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* flag = node.as_boolean()) return flag->get();
  if (const auto* whole = node.as_integer()) return whole->get();
  if (const auto* real = node.as_floating_point()) return real->get();
  if (const auto* list = node.as_array()) {
    std::vector<std::string> texts;
    for (const toml::node& item : *list) {
      if (item.is_array()) throw InvalidArgument("a list in a list", where);
      texts.push_back(to_text(value_of_node(item, where)));
    }
    return texts;
  }
  throw InvalidArgument("the value must be a text, a number, true or false, or a list", where);
}

// As TOML; numbers in their shortest exact form, which toml++ does not write.
struct TomlOf {
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(std::int64_t value) const { return std::to_string(value); }
  std::string operator()(double value) const {
    const std::string text = shortest(value);
    return text.find_first_not_of("-0123456789") == std::string::npos ? text + ".0" : text;
  }
  std::string operator()(const std::string& value) const {
    std::ostringstream out;
    out << toml::value<std::string>(value);
    return out.str();
  }
  std::string operator()(const std::vector<std::string>& values) const {
    std::string text;
    for (const std::string& value : values) text += (text.empty() ? "" : ", ") + (*this)(value);
    return "[" + text + "]";
  }
};

std::string absolute_path(const std::string& text) {
  std::error_code unknown;
  return fs::exists(text, unknown) ? fs::absolute(text).string() : text;
}

// As it is compared and shown; "" where the key is missing.
std::string comparable(const SettingValues& job, const std::string& key) {
  const auto found = job.find(key);
  if (found == job.end()) return "";
  if (key != "video") return to_text(found->second);
  std::vector<std::string> paths;
  assign(found->second, paths, key);
  for (std::string& path : paths) path = fs::path(path).filename().string();
  return to_text(paths);
}

}  // namespace

void SettingWriter::note(const Setting& setting, SettingValue value) {
  if (setting.kind & (kMayChange | kAfterwards | kGoesBack)) may_change_.emplace_back(setting.key);
  if (setting.kind & kAfterwards) afterwards_.emplace_back(setting.key);
  if (setting.attribute != nullptr) attributes_[setting.attribute] = value;
  if (auto* flag = std::get_if<bool>(&value)) {
    if (setting.kind & kNegated) *flag = !*flag;
    if (*flag) values_[setting.key] = true;
    return;
  }
  const std::string text = to_text(value);
  if ((setting.kind & kZeroUnset) && text == "0") return;
  if ((setting.kind & kEmptyUnset) && text.empty()) return;
  if (setting.kind & kPath) {
    if (auto* path = std::get_if<std::string>(&value)) *path = absolute_path(*path);
    if (auto* paths = std::get_if<std::vector<std::string>>(&value)) {
      for (std::string& path : *paths) path = absolute_path(path);
      if (paths->size() == 1) value = std::string(paths->front());
    }
  }
  values_[setting.key] = std::move(value);
}

void SettingWriter::describe(report::Attributes& attributes) const {
  for (const auto& [name, value] : attributes_) {
    if (const auto* whole = std::get_if<std::int64_t>(&value)) {
      attributes[name] = static_cast<double>(*whole);
    } else if (const auto* real = std::get_if<double>(&value)) {
      attributes[name] = *real;
    } else {
      attributes[name] = to_text(value);
    }
  }
}

SettingValues read_job_file(const fs::path& path) {
  SettingValues values;
  try {
    for (const auto& [key, node] : toml::parse(read_toml_text(path))) {
      const std::string name(key.str());
      values[name] = value_of_node(node, path.string() + ", key " + name);
    }
  } catch (const toml::parse_error& error) {
    throw InvalidArgument(std::string(error.description()),
                          path.string() + ", line " + std::to_string(error.source().begin.line));
  }
  return values;
}

std::string job_text(const std::string& command, const SettingValues& values) {
  SettingValues all = values;
  all["command"] = command;
  all["version"] = std::string(IMPACTDIC_VERSION);
  std::string text;
  for (const auto& [key, value] : all) text += key + " = " + std::visit(TomlOf(), value) + "\n";
  return text;
}

void write_job_file(const fs::path& path, const std::string& command, const SettingValues& values) {
  // In one step: without its job a run cannot be gone on with.
  const fs::path part = path.string() + ".part";
  {
    std::ofstream file(part);
    file << job_text(command, values) << std::flush;
    if (!file) throw FileError("cannot write the file", path.string());
  }
  std::error_code error;
  fs::rename(part, path, error);
  if (error) throw FileError("cannot replace the file: " + error.message(), path.string());
}

namespace {

// `path`: of the earlier job.
void require_same(const fs::path& path, const SettingValues& earlier, const SettingValues& now,
                  const std::set<std::string>& keys) {
  for (const std::string& key : keys) {
    const std::string before = comparable(earlier, key), wanted = comparable(now, key);
    if (before == wanted) continue;
    throw InvalidArgument(
        "the earlier run has " + key + " '" + before + "', this one '" + wanted + "'",
        path.string(), "go on with the same, or start anew with --force");
  }
}

}  // namespace

void require_same_job(const fs::path& path, const SettingWriter& now) {
  const SettingValues earlier = read_job_file(path);
  SettingValues wanted_now = now.values();
  wanted_now["version"] = std::string(IMPACTDIC_VERSION);
  std::set<std::string> keys;
  for (const auto& [key, value] : earlier) keys.insert(key);
  for (const auto& [key, value] : wanted_now) keys.insert(key);
  for (const std::string& free : now.may_change()) keys.erase(free);
  keys.erase("command");
  require_same(path, earlier, wanted_now, keys);
}

void require_same_sight(const fs::path& path, const SettingWriter& now) {
  const SettingValues earlier = read_job_file(path);
  const auto from_near = [](const SettingValues& job) {
    return job.count("distance-mm") > 0 || job.count("camera") > 0;
  };
  if (!from_near(earlier) && !from_near(now.values())) return;
  require_same(path, earlier, now.values(),
               {"ball-diameter-mm", "ball-diameter-sd-mm", "camera", "distance-mm",
                "distance-sd-mm", "mm-per-px", "mm-per-px-sd"});
}

std::vector<BallByHand> corrections_of(const fs::path& path) {
  const SettingValues job = read_job_file(path);
  std::vector<BallByHand> balls;
  const auto found = job.find("ball-at");
  if (found != job.end()) assign(found->second, balls, path.string() + ", key ball-at");
  return balls;
}

bool same_afterwards(const fs::path& path, const SettingWriter& now) {
  const SettingValues earlier = read_job_file(path);
  return std::all_of(now.afterwards().begin(), now.afterwards().end(), [&](const auto& key) {
    return comparable(earlier, key) == comparable(now.values(), key);
  });
}

}  // namespace impactdic::run
