#include "host/cli/quantity.h"

#include <impactdic/error.h>

#include <CLI/CLI.hpp>
#include <cctype>
#include <cmath>
#include <map>
#include <utility>

#include "host/base/parse.h"

namespace impactdic::cli {
namespace {

constexpr double kPerRadian = 180 / 3.14159265358979323846;

// Of each unit that options take: what one of another unit is in it.
const std::map<std::string, std::map<std::string, double>>& factors() {
  static const std::map<std::string, std::map<std::string, double>> all = {
      {"mm", {{"mm", 1}, {"cm", 10}, {"m", 1000}, {"um", 1e-3}, {"µm", 1e-3}, {"in", 25.4}}},
      {"deg", {{"deg", 1}, {"°", 1}, {"rad", kPerRadian}}},
      {"px", {{"px", 1}}},
      {"fps", {{"fps", 1}, {"kfps", 1e3}, {"Mfps", 1e6}, {"Hz", 1}, {"kHz", 1e3}, {"1/s", 1}}},
      {"g", {{"g", 1}, {"kg", 1e3}, {"mg", 1e-3}}},
      {"s", {{"s", 1}, {"ms", 1e-3}, {"us", 1e-6}, {"µs", 1e-6}, {"min", 60}}},
  };
  return all;
}

// The units of options whose name does not end in it.
const std::map<std::string, std::string>& by_name() {
  static const std::map<std::string, std::string> all = {
      {"window", "px"}, {"spacing", "px"}, {"search", "px"},   {"max-sd", "px"},
      {"wait", "s"},    {"lag", "s"},      {"lost-after", "s"}};
  return all;
}

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

// Where the number ends.
std::size_t number_length(const std::string& text) {
  std::size_t i = 0;
  const auto digits = [&] {
    while (i < text.size() && std::isdigit(static_cast<unsigned char>(text[i])) != 0) ++i;
  };
  if (i < text.size() && (text[i] == '+' || text[i] == '-')) ++i;
  digits();
  if (i < text.size() && text[i] == '.') ++i;
  digits();
  if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
    const std::size_t mark = i++;
    if (i < text.size() && (text[i] == '+' || text[i] == '-')) ++i;
    const std::size_t first = i;
    digits();
    if (i == first) i = mark;  // the e begins a unit
  }
  return i;
}

}  // namespace

std::string unit_of(const std::string& option) {
  const auto named = by_name().find(option);
  if (named != by_name().end()) return named->second;
  if (option == "fps") return "fps";
  // --mm-per-px is no length.
  if (option.find("-per-") != std::string::npos) return "";
  for (const char* unit : {"mm", "deg", "px", "g"}) {
    if (ends_with(option, std::string("-") + unit)) return unit;
  }
  return "";
}

bool is_unit_for(const std::string& text, const std::string& unit) {
  const auto known = factors().find(unit);
  return known != factors().end() && known->second.count(text) > 0;
}

std::optional<std::string> in_unit(const std::string& text, const std::string& unit) {
  const std::size_t length = number_length(text);
  const std::string number = text.substr(0, length), given = trim(text.substr(length));
  double value = 0;
  if (number.empty() || !CLI::detail::lexical_cast(number, value)) return std::nullopt;
  if (given.empty()) return number;
  if (!is_unit_for(given, unit)) return std::nullopt;
  const double factor = factors().at(unit).at(given);
  return factor == 1 ? number : shortest(value * factor);
}

void take_units(CLI::App& command) {
  for (CLI::Option* option : command.get_options()) {
    if (option->get_lnames().empty() || option->get_items_expected_max() != 1) continue;
    const std::string unit = unit_of(option->get_lnames().front());
    const std::string type = option->get_type_name();
    if (unit.empty() || (type.rfind("FLOAT", 0) != 0 && type.rfind("INT", 0) != 0)) continue;
    option->transform(CLI::Validator(
        [unit](std::string& text) {
          double plain = 0;
          if (CLI::detail::lexical_cast(text, plain)) return std::string();
          const std::optional<std::string> number = in_unit(text, unit);
          if (!number) return "must be a number in " + unit + ", not " + text;
          text = *number;
          return std::string();
        },
        ""));
  }
}

}  // namespace impactdic::cli
