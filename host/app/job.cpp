#include "host/app/job.h"

#include <impactdic/error.h>
#include <toml++/toml.h>

#include <algorithm>
#include <fstream>
#include <set>

namespace impactdic::app {
namespace {

// Options that belong to one run, not to the job.
const std::set<std::string> kNotInJobs = {"output", "job",     "help",  "quiet",
                                          "v",      "verbose", "force", "resume"};

std::string key_of(const CLI::Option& option) {
  const auto longs = option.get_lnames();
  return longs.empty() ? option.get_name(true) : longs.front();
}

const CLI::Option* find_option(const CLI::App& command, const std::string& key) {
  for (const CLI::Option* option : command.get_options()) {
    if (key_of(*option) == key) return option;
  }
  return nullptr;
}

std::string text_of(const toml::node& node, const std::string& where) {
  if (const auto* text = node.as_string()) return text->get();
  if (node.is_integer() || node.is_floating_point()) {
    std::ostringstream out;
    if (const auto* whole = node.as_integer()) out << whole->get();
    if (const auto* real = node.as_floating_point()) out << *real;
    return out.str();
  }
  throw InvalidArgument("the value must be a text, a number, true or false, or a list", where);
}

void append_option(const CLI::Option& option, const std::string& key, const toml::node& node,
                   const std::string& where, std::vector<std::string>& out) {
  std::vector<std::string> values;
  if (const auto* flag = node.as_boolean()) {
    if (option.get_expected_max() != 0) {
      throw InvalidArgument("the value must not be true or false", where);
    }
    if (flag->get()) out.push_back("--" + key);
    return;
  }
  if (const auto* list = node.as_array()) {
    for (const toml::node& item : *list) values.push_back(text_of(item, where));
  } else {
    values.push_back(text_of(node, where));
  }
  if (option.get_positional()) {
    out.insert(out.end(), values.begin(), values.end());
  } else {
    for (const std::string& value : values) out.push_back("--" + key + "=" + value);
  }
}

// The option that `argument` ("--window", "--window=15", "-j", "-j4") names; nullptr for a value.
const CLI::Option* named_by(const CLI::App& command, const std::string& argument) {
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) {
      if (argument == "--" + name || argument.rfind("--" + name + "=", 0) == 0) return option;
    }
    for (const std::string& name : option->get_snames()) {
      if (argument.rfind("-" + name, 0) == 0 && argument.rfind("--", 0) != 0) return option;
    }
  }
  return nullptr;
}

// Which options the command line itself gives; a value that belongs to no option stands for the
// positional one.
std::set<const CLI::Option*> given_options(const CLI::App& command,
                                           const std::vector<std::string>& arguments) {
  std::set<const CLI::Option*> given;
  bool value_follows = false;
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    if (value_follows) {
      value_follows = false;
      continue;
    }
    if (const CLI::Option* option = named_by(command, argument)) {
      given.insert(option);
      const bool attached =
          argument.find('=') != std::string::npos || (argument.size() > 2 && argument[1] != '-');
      value_follows = option->get_expected_max() > 0 && !attached;
    } else {
      for (const CLI::Option* option : command.get_options()) {
        if (option->get_positional()) given.insert(option);
      }
    }
  }
  return given;
}

toml::table parse_job(const std::string& file) {
  if (!std::filesystem::is_regular_file(file)) throw FileError("cannot read the job file", file);
  try {
    return toml::parse_file(file);
  } catch (const toml::parse_error& error) {
    throw InvalidArgument(std::string(error.description()),
                          file + ", line " + std::to_string(error.source().begin.line));
  }
}

std::vector<std::string> read_job(const CLI::App& command, const std::string& file,
                                  const std::vector<std::string>& arguments) {
  const toml::table table = parse_job(file);
  const std::set<const CLI::Option*> given = given_options(command, arguments);
  std::vector<std::string> out;
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    const std::string where = file + ", key " + name;
    if (name == "command" || name == "version") continue;
    const CLI::Option* option = find_option(command, name);
    if (option == nullptr || kNotInJobs.count(name) != 0) {
      throw InvalidArgument("unknown key '" + name + "'", file,
                            "the keys are the options of impactdic " + command.get_name() +
                                " --help without their dashes");
    }
    if (given.count(option) == 0) append_option(*option, name, node, where, out);
  }
  return out;
}

toml::array values_of(const CLI::Option& option) {
  toml::array values;
  for (const std::string& text : option.results()) {
    const bool path = option.get_positional() && std::filesystem::exists(text);
    values.push_back(path ? std::filesystem::absolute(text).string() : text);
  }
  return values;
}

toml::table job_of(const CLI::App& command) {
  toml::table table;
  table.insert("command", command.get_name());
  table.insert("version", IMPACTDIC_VERSION);
  for (const CLI::Option* option : command.get_options()) {
    const std::string key = key_of(*option);
    if (kNotInJobs.count(key) != 0) continue;
    if (option->get_expected_max() == 0) {  // a flag
      if (option->count() > 0) table.insert(key, true);
      continue;
    }
    if (option->count() > 0) {
      toml::array values = values_of(*option);
      if (values.size() == 1) {
        table.insert(key, *values[0].as_string());
      } else {
        table.insert(key, std::move(values));
      }
    } else if (!option->get_default_str().empty()) {
      table.insert(key, option->get_default_str());
    }
  }
  return table;
}

// As it is shown to a person; "" where the key is missing.
std::string value_in(const toml::table& job, const std::string& key) {
  const toml::node* node = job.get(key);
  if (node == nullptr) return "";
  if (const auto* text = node->as_string()) {
    return key == "video" ? std::filesystem::path(text->get()).filename().string() : text->get();
  }
  std::ostringstream out;
  node->visit([&](const auto& value) { out << value; });
  return out.str();
}

}  // namespace

std::vector<std::string> expand_job(const CLI::App& app, std::vector<std::string> arguments) {
  if (arguments.empty()) return arguments;
  const CLI::App* command = nullptr;
  for (const CLI::App* candidate : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (candidate->get_name() == arguments.front()) command = candidate;
  }
  if (command == nullptr || find_option(*command, "job") == nullptr) return arguments;
  std::string file;
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    if (arguments[i] == "--job" && i + 1 < arguments.size()) file = arguments[i + 1];
    if (arguments[i].rfind("--job=", 0) == 0) file = arguments[i].substr(6);
  }
  if (file.empty()) return arguments;
  const std::vector<std::string> from_job = read_job(*command, file, arguments);
  arguments.insert(arguments.begin() + 1, from_job.begin(), from_job.end());
  return arguments;
}

void write_job(const CLI::App& command, const std::filesystem::path& path) {
  std::ofstream file(path);
  file << job_of(command) << "\n" << std::flush;
  if (!file) throw FileError("cannot write the file", path.string());
}

void require_same_job(const CLI::App& command, const std::filesystem::path& path,
                      const std::set<std::string>& may_differ) {
  const toml::table earlier = parse_job(path.string()), now = job_of(command);
  std::set<std::string> keys;
  for (const toml::table* job : {&earlier, &now}) {
    for (const auto& [key, node] : *job) keys.emplace(key.str());
  }
  for (const std::string& key : keys) {
    const std::string before = value_in(earlier, key), wanted = value_in(now, key);
    if (before == wanted || key == "command" || may_differ.count(key) != 0) continue;
    throw InvalidArgument(
        "the earlier run has " + key + " '" + before + "', this one '" + wanted + "'",
        path.string(), "go on with the same, or start anew with --force");
  }
}

}  // namespace impactdic::app
