// What a run warned of.
#pragma once

#include <impactdic/track.h>

#include <algorithm>
#include <string>

namespace impactdic::testing {

inline bool says(const TrackResult& result, const std::string& words) {
  return std::any_of(result.warnings.begin(), result.warnings.end(), [&](const std::string& text) {
    return text.find(words) != std::string::npos;
  });
}

}  // namespace impactdic::testing
