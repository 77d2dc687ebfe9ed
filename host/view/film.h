// Frames with what was measured on them as a film that browsers play.
#pragma once

#include <cstdint>
#include <string>

#include "host/view/shot.h"

namespace impactdic::view {

struct FilmRequest {
  std::int64_t first = 0, end = 0, step = 1;  // frames of the stored file, `end` excluded
  double rate = 25;                           // pictures a second
  Contrast contrast;
  void validate() const;  // throws InvalidArgument
};

// The MP4's bytes: outline, path, arrows, scale. A frame that was not measured, or a shot without
// results, is shown as it is. Throws InvalidArgument for frames that the clip lacks or too many of
// them, NotThere without a clip or without codecs, FileError, FormatError.
std::string film_of(Shot& shot, const FilmRequest& request);

}  // namespace impactdic::view
