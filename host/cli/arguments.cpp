#include "host/cli/arguments.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "host/cli/nearest.h"
#include "host/cli/quantity.h"

namespace impactdic::cli {
namespace {

using Texts = std::vector<std::string>;

bool holds(const Texts& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// "--fps=3" -> "--fps"
std::string name_in(const std::string& argument) { return argument.substr(0, argument.find('=')); }

bool is_long(const std::string& argument) {
  return argument.size() > 2 && argument.rfind("--", 0) == 0;
}

// -o, -ofolder, but neither - nor -30.
bool is_short(const std::string& argument) {
  return argument.size() > 1 && argument[0] == '-' &&
         std::isalpha(static_cast<unsigned char>(argument[1])) != 0;
}

const CLI::Option* option_of(const CLI::App& command, const std::string& argument) {
  for (const CLI::Option* option : command.get_options()) {
    if (is_long(argument) ? holds(option->get_lnames(), name_in(argument).substr(2))
                          : holds(option->get_snames(), argument.substr(1, 1))) {
      return option;
    }
  }
  return nullptr;
}

Texts long_names(const CLI::App& command) {
  Texts names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back(name);
  }
  return names;
}

Texts command_names(const CLI::App& app) {
  Texts names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

const CLI::App* command_of(const CLI::App& app, const Texts& arguments) {
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (!arguments.empty() && command->get_name() == arguments.front()) return command;
  }
  return nullptr;
}

// How many arguments behind this one are the option's values, whatever they look like.
std::size_t values_behind(const CLI::Option& option, const std::string& argument) {
  const bool holds_value =
      is_long(argument) ? argument.find('=') != std::string::npos : argument.size() > 2;
  return holds_value ? 0 : static_cast<std::size_t>(std::max(0, option.get_items_expected_min()));
}

std::string with_hint(const std::string& what, const std::string& hint) {
  return hint.empty() ? what : what + ": " + hint;
}

}  // namespace

std::string misspelt_name(const CLI::App& app, const Texts& arguments) {
  if (arguments.empty()) return "";
  const CLI::App* command = command_of(app, arguments);
  if (command == nullptr && !is_long(arguments.front()) && !is_short(arguments.front())) {
    return with_hint("there is no command '" + arguments.front() + "'",
                     did_you_mean(nearest(arguments.front(), command_names(app)), ""));
  }
  const CLI::App& reader = command != nullptr ? *command : app;
  for (std::size_t i = command != nullptr ? 1 : 0; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    if (argument == "--") break;
    if (!is_long(argument) && !is_short(argument)) continue;
    if (const CLI::Option* option = option_of(reader, argument)) {
      i += values_behind(*option, argument);
      continue;
    }
    const std::string name = is_long(argument) ? name_in(argument) : argument.substr(0, 2);
    const Texts meant = is_long(argument) ? nearest(name.substr(2), long_names(reader)) : Texts();
    return with_hint("there is no option " + name, did_you_mean(meant, "--"));
  }
  return "";
}

Texts join_units(const CLI::App& app, const Texts& arguments) {
  const CLI::App* command = command_of(app, arguments);
  if (command == nullptr) return arguments;
  Texts joined;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    joined.push_back(arguments[i]);
    if (arguments[i] == "--") {
      joined.insert(joined.end(), arguments.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                    arguments.end());
      break;
    }
    if (!is_long(arguments[i]) || i == 0) continue;
    const CLI::Option* option = option_of(*command, arguments[i]);
    if (option == nullptr) continue;
    for (std::size_t values = values_behind(*option, arguments[i]);
         values > 0 && i + 1 < arguments.size(); --values) {
      joined.push_back(arguments[++i]);
    }
    const std::string unit = unit_of(option->get_lnames().front());
    if (i + 1 < arguments.size() && is_unit_for(arguments[i + 1], unit) &&
        !std::filesystem::exists(arguments[i + 1])) {
      joined.back() += arguments[++i];
    }
  }
  return joined;
}

std::string meant_option(const CLI::App& command, const std::string& key) {
  return did_you_mean(nearest(key, long_names(command)), "");
}

}  // namespace impactdic::cli
