// Numbers with their unit: 6.7cm, 30kfps.
#pragma once

#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace impactdic::cli {

// The unit in which an option takes its number, by its long name: --…-mm, --…-deg, --…-px, --fps,
// --mass-g, … "" where its name has none.
std::string unit_of(const std::string& option);

// Whether `text` is a unit that can be told in `unit`, such as cm in mm.
bool is_unit_for(const std::string& text, const std::string& unit);

// "6.7cm" in "mm" -> "67"; a number without a unit stays as it was typed. nullopt where it is no
// number, or the unit measures something else.
std::optional<std::string> in_unit(const std::string& text, const std::string& unit);

// Has every option of the command whose name has a unit take numbers with one.
void take_units(CLI::App& command);

}  // namespace impactdic::cli
