// The arguments before CLI11 reads them: names that do not exist are told first, whatever else is
// wrong, with what was probably meant; a unit that stands apart joins its number.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace impactdic::cli {

// What is wrong with a name in the arguments, in words; "" where all exist. `arguments`: without
// the program's own name.
std::string misspelt_name(const CLI::App& app, const std::vector<std::string>& arguments);

// The arguments with "30" "kfps" as "30kfps", where an option takes that unit and no file has its
// name.
std::vector<std::string> join_units(const CLI::App& app, const std::vector<std::string>& arguments);

// "did you mean …?" for the key of a job file; "" where nothing is near.
std::string meant_option(const CLI::App& command, const std::string& key);

}  // namespace impactdic::cli
