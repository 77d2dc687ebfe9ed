// Names in the order that people expect: frame9.tif before frame10.tif.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace impactdic::video {

// Runs of digits compare as numbers, everything else byte by byte; equal numbers with fewer
// leading zeros come first.
bool natural_less(std::string_view a, std::string_view b);

// The picture files of a folder, in natural order. Pictures of several kinds, or none, throw
// InvalidArgument.
std::vector<std::string> pictures_in_folder(const std::string& folder);
// The files that a pattern of *, ? and [] names, in natural order. None throws FileError.
std::vector<std::string> files_of_pattern(const std::string& pattern);
bool is_pattern(const std::string& text);

}  // namespace impactdic::video
