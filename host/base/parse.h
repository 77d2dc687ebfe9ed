// Text to numbers, strictly: the whole text must be the number; and back.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace impactdic {

// Each throws InvalidArgument naming `what` where the text is not such a number.
double parse_double(std::string_view text, const std::string& what);
std::int64_t parse_int(std::string_view text, const std::string& what);
// "4,3,2,1" -> {4, 3, 2, 1}; exactly `count` of them unless count is 0.
std::vector<double> parse_doubles(std::string_view text, char separator, std::size_t count,
                                  const std::string& what);
std::vector<std::string> split(std::string_view text, char separator);
std::string trim(std::string_view text);
// The shortest decimal that reads back as exactly this double; "" for NaN.
std::string shortest(double value);
// "12.30 +- 0.21": both to the second digit of the deviation; six digits where that is 0 or
// unknown.
std::string plus_minus(double value, double sd);

}  // namespace impactdic
