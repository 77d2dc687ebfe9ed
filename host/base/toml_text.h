// Job files before they are parsed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace impactdic {

// A parser and what it makes go one call deeper with every level of a value or a key.
inline constexpr int kMostTomlLevels = 64;
inline constexpr std::uintmax_t kMostTomlBytes = std::uintmax_t{16} << 20;

// Reads a TOML file. Throws FileError where it cannot be read; InvalidArgument where it is longer
// than kMostTomlBytes, or where a value or a dotted key nests deeper than kMostTomlLevels.
std::string read_toml_text(const std::filesystem::path& file);
// The second check alone; `where` names the text.
void check_toml_nesting(std::string_view text, const std::string& where);

}  // namespace impactdic
