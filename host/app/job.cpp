#include "host/app/job.h"

#include <impactdic/error.h>

#include <set>

#include "host/cli/arguments.h"
#include "host/run/settings/job_file.h"

namespace impactdic::app {
namespace {

// Options that belong to one run, not to the job.
const std::set<std::string> kNotInJobs = {"output", "job",     "help",      "help-all",
                                          "quiet",  "v",       "verbose",   "force",
                                          "resume", "sandbox", "no-sandbox"};

std::string key_of(const CLI::Option& option) {
  const auto& longs = option.get_lnames();
  return longs.empty() ? option.get_name(true) : longs.front();
}

CLI::Option* find_option(CLI::App& command, const std::string& key) {
  for (CLI::Option* option : command.get_options()) {
    if (key_of(*option) == key && kNotInJobs.count(key) == 0) return option;
  }
  return nullptr;
}

std::vector<std::string> values_of(const CLI::Option& option) {
  std::vector<std::string> values;
  for (const std::string& text : option.results()) {
    const bool path = option.get_positional() && std::filesystem::exists(text);
    values.push_back(path ? std::filesystem::absolute(text).string() : text);
  }
  return values;
}

}  // namespace

void apply_job(CLI::App& command, const std::string& file) {
  for (const auto& [key, value] : run::read_job_file(file)) {
    if (key == "command" || key == "version") continue;
    CLI::Option* const option = find_option(command, key);
    if (option == nullptr) {
      const std::string meant = cli::meant_option(command, key);
      throw InvalidArgument("unknown key '" + key + "'", file,
                            meant + (meant.empty() ? "" : " ") + "the keys are the options of " +
                                "impactdic " + command.get_name() +
                                " --help-all without their dashes");
    }
    const bool is_flag = option->get_expected_max() == 0;
    if (is_flag != std::holds_alternative<bool>(value)) {
      throw InvalidArgument(
          is_flag ? "the value must be true or false" : "the value must not be true or false",
          file + ", key " + key);
    }
    if (!option->empty() || run::to_text(value) == "false") continue;
    std::vector<std::string> texts;
    run::assign(value, texts, key);
    option->add_result(texts);
    option->run_callback();
  }
}

void write_job(const CLI::App& command, const std::filesystem::path& path) {
  run::SettingValues settings;
  for (const CLI::Option* option : command.get_options()) {
    const std::string key = key_of(*option);
    if (kNotInJobs.count(key) != 0) continue;
    if (option->get_expected_max() == 0) {  // a flag
      if (option->count() > 0) settings[key] = true;
    } else if (option->count() > 0) {
      const std::vector<std::string> values = values_of(*option);
      if (values.size() == 1) {
        settings[key] = values.front();
      } else {
        settings[key] = values;
      }
    } else if (!option->get_default_str().empty()) {
      settings[key] = option->get_default_str();
    }
  }
  run::write_job_file(path, command.get_name(), settings);
}

}  // namespace impactdic::app
