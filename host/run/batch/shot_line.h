// A shot of a batch as one line of text, which its ticket carries to whoever measures it.
#pragma once

#include <string>

#include "host/run/batch_table.h"

namespace impactdic::run {

std::string to_line(const BatchShot& shot);
// Throws FormatError; `where`: the file.
BatchShot parse_shot_line(const std::string& line, const std::string& where);

}  // namespace impactdic::run
