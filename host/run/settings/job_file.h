// job.toml: the settings of a run, with which it can be run again, bit for bit on the same device.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "host/report/fields_file.h"
#include "host/run/settings/setting_value.h"
#include "host/run/settings/settings.h"

namespace impactdic::run {

// Collects the settings that a list visits. Those that stand for nothing given are left out, and a
// flag that is not set; paths that exist become absolute.
class SettingWriter {
 public:
  template <typename T>
  void operator()(const Setting& setting, const T& member) {
    note(setting, value_of(member));
  }
  const SettingValues& values() const { return values_; }
  // Keys that may differ in a run that goes on.
  const std::vector<std::string>& may_change() const { return may_change_; }
  // Those among them that decide figures which are worked out of the rows.
  const std::vector<std::string>& afterwards() const { return afterwards_; }
  // Those that have a place among the attributes of fields.h5.
  void describe(report::Attributes& attributes) const;

 private:
  void note(const Setting& setting, SettingValue value);
  SettingValues values_;
  std::vector<std::string> may_change_, afterwards_;
  std::map<std::string, SettingValue> attributes_;
};

// Puts `values` into the settings that a list visits; what has no value stays as it is.
class SettingReader {
 public:
  // `where`: the file, for errors.
  SettingReader(const SettingValues& values, std::string where)
      : values_(values), where_(std::move(where)) {}
  template <typename T>
  void operator()(const Setting& setting, T& member) const {
    const auto found = values_.find(setting.key);
    if (found == values_.end()) return;
    assign(found->second, member, where_ + ", key " + setting.key);
    if constexpr (std::is_same_v<T, bool>) {
      if (setting.kind & kNegated) member = !member;
    }
  }

 private:
  const SettingValues& values_;
  std::string where_;
};

// Reads a job as it stands. Throws FileError where there is no such file, InvalidArgument where it
// is no TOML or a value is a table.
SettingValues read_job_file(const std::filesystem::path& path);

// What job.toml holds: the settings, the command's name and the version.
std::string job_text(const std::string& command, const SettingValues& values);

// Writes it. Throws FileError.
void write_job_file(const std::filesystem::path& path, const std::string& command,
                    const SettingValues& values);

// Throws InvalidArgument where a setting of `now` differs from that in the job `path` of an earlier
// run, but for those that may. Of the clip only the files' names count.
void require_same_job(const std::filesystem::path& path, const SettingWriter& now);

// The frames that the job `path` corrects by hand. Throws as read_job_file.
std::vector<BallByHand> corrections_of(const std::filesystem::path& path);

// What settles from where a ball is seen is part of how a sphere is measured in perspective. Throws
// InvalidArgument where one of the jobs has a distance or a camera and they differ in any of it.
void require_same_sight(const std::filesystem::path& path, const SettingWriter& now);

// Whether the job `path` has the settings of `now` that come in after the last frame.
bool same_afterwards(const std::filesystem::path& path, const SettingWriter& now);

}  // namespace impactdic::run
