// A calibration's pictures, out of any bytes.
#pragma once

#include <string>

namespace impactdic::fuzz {

// A picture of 48 x 36 pixels behind a byte that says which target is looked for.
void find_target(const std::string& text);

}  // namespace impactdic::fuzz
