// The settings of a request as options of its command.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>

#include "host/run/settings/setting_value.h"
#include "host/run/settings/settings.h"

namespace impactdic::app {

struct OptionHelp {
  std::string text;
  CLI::Validator check;  // of the value; without a description: none
};
// By the settings' keys.
using OptionHelps = std::map<std::string, OptionHelp>;

// Of the settings of track, correlate and batch.
const OptionHelps& setting_helps();

// Adds an option for every setting that a list visits. The request must outlive the command.
class OptionAdder {
 public:
  explicit OptionAdder(CLI::App& command) : command_(command) {}

  template <typename T>
  void operator()(const run::Setting& setting, T& member) {
    const OptionHelp& help = setting_helps().at(setting.key);
    const std::string name = std::string("--") + setting.key;
    CLI::Option* option = nullptr;
    if constexpr (std::is_same_v<T, bool>) {
      const bool value = (setting.kind & run::kNegated) == 0;
      command_.add_flag_callback(
          name, [&member, value] { member = value; }, help.text);
      return;
    } else if constexpr (std::is_same_v<T, std::vector<std::string>>) {
      command_.add_option(setting.key, member, help.text)->required();
      return;
    } else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
      option = command_.add_option(name, member, help.text);
    } else {
      option = command_.add_option_function<std::string>(
          name, [&member, name](const std::string& text) { run::assign(text, member, name); },
          help.text);
    }
    if (!help.check.get_description().empty()) option->check(help.check);
    if ((setting.kind & (run::kZeroUnset | run::kEmptyUnset)) == 0) {
      option->default_str(run::to_text(run::value_of(member)));
    }
  }

 private:
  CLI::App& command_;
};

}  // namespace impactdic::app
