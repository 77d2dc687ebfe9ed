// Checks of an option's value.
#pragma once

#include <CLI/CLI.hpp>

namespace impactdic::cli {

CLI::Validator positive_number();
CLI::Validator non_negative_number();
// Has every option of a command that is a number refuse what is none: NaN, infinity, a negative
// count.
void refuse_non_numbers(CLI::App& command);

}  // namespace impactdic::cli
