#include "host/cli/checks.h"

#include <cmath>
#include <string>

namespace impactdic::cli {
namespace {

// A number of which `good` holds; `must` says what that is.
template <typename Good>
CLI::Validator number_check(const std::string& must, const std::string& name, Good good) {
  return CLI::Validator(
      [must, good](std::string& text) {
        double value = 0;
        const bool fine = CLI::detail::lexical_cast(text, value) && good(value);
        return fine ? std::string() : "must be " + must + ", not " + text;
      },
      name);
}

}  // namespace

CLI::Validator positive_number() {
  return number_check("positive", "POSITIVE",
                      [](double value) { return value > 0 && std::isfinite(value); });
}

CLI::Validator non_negative_number() {
  return number_check("0 or more", "NONNEGATIVE",
                      [](double value) { return value >= 0 && std::isfinite(value); });
}

void refuse_non_numbers(CLI::App& command) {
  const auto finite =
      number_check("a finite number", "", [](double v) { return std::isfinite(v); });
  const auto count = number_check("0 or more", "", [](double value) { return value >= 0; });
  for (CLI::Option* option : command.get_options()) {
    const std::string type = option->get_type_name();
    if (type.rfind("FLOAT", 0) == 0) option->check(finite);
    if (type.rfind("UINT", 0) == 0) option->check(count);
  }
}

}  // namespace impactdic::cli
