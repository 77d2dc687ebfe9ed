#include "host/base/parse.h"

#include <impactdic/error.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace impactdic {

namespace {
template <typename T>
T parse_number(std::string_view text, const std::string& what, const char* kind) {
  T value{};
  const std::string trimmed = trim(text);
  const char* begin = trimmed.data();
  const char* end = begin + trimmed.size();
  if (begin != end && *begin == '+') ++begin;
  const auto [stop, code] = std::from_chars(begin, end, value);
  if (code != std::errc() || stop != end || begin == end) {
    throw InvalidArgument("'" + trimmed + "' is not " + kind, what);
  }
  return value;
}
}  // namespace

double parse_double(std::string_view text, const std::string& what) {
  const double value = parse_number<double>(text, what, "a number");
  if (!std::isfinite(value)) throw InvalidArgument("the number must be finite", what);
  return value;
}

std::int64_t parse_int(std::string_view text, const std::string& what) {
  return parse_number<std::int64_t>(text, what, "a whole number");
}

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  while (true) {
    const std::size_t end = text.find(separator, begin);
    parts.emplace_back(text.substr(begin, end - begin));
    if (end == std::string_view::npos) return parts;
    begin = end + 1;
  }
}

std::vector<double> parse_doubles(std::string_view text, char separator, std::size_t count,
                                  const std::string& what) {
  std::vector<double> values;
  for (const std::string& part : split(text, separator)) values.push_back(parse_double(part, what));
  if (count != 0 && values.size() != count) {
    throw InvalidArgument("'" + std::string(text) + "' must be " + std::to_string(count) +
                              " numbers separated by '" + separator + "'",
                          what);
  }
  return values;
}

std::string trim(std::string_view text) {
  const char* blank = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(blank);
  if (begin == std::string_view::npos) return "";
  return std::string(text.substr(begin, text.find_last_not_of(blank) - begin + 1));
}

std::string shortest(double value) {
  if (std::isnan(value)) return "";
  char buffer[40];
  const auto [end, code] = std::to_chars(buffer, buffer + sizeof buffer, value);
  (void)code;
  return std::string(buffer, end);
}

namespace {

std::string in_format(double value, std::chars_format format, int precision) {
  char buffer[400];  // the largest double has 309 digits before its point
  const auto [end, code] = std::to_chars(buffer, buffer + sizeof buffer, value, format, precision);
  (void)code;
  return std::string(buffer, end);
}

}  // namespace

std::string plus_minus(double value, double sd) {
  if (!(sd > 0) || !std::isfinite(sd)) {
    return in_format(value, std::chars_format::general, 6) + " +- " +
           in_format(sd, std::chars_format::general, 2);
  }
  // As it is printed: 0.0996 has its second digit where 0.10 has it.
  const std::string digits = in_format(sd, std::chars_format::scientific, 1);
  const int power = std::stoi(digits.substr(digits.find('e') + 1));
  const int decimals = std::clamp(1 - power, 0, 17);
  return in_format(value, std::chars_format::fixed, decimals) + " +- " +
         in_format(sd, std::chars_format::fixed, decimals);
}

}  // namespace impactdic
