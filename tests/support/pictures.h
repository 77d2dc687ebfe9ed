// Pictures of real surfaces, read as the program reads them.
#pragma once

#include <string>

#include "host/video/frame_source.h"
#include "tests/support/data.h"

namespace impactdic::testing {

// `file` lies in the folder of real data.
inline Frame read_picture(const std::string& file) {
  const auto source = video::open_video({data_path(file).string()});
  Frame frame;
  source->read(0, frame);
  return frame;
}

}  // namespace impactdic::testing
