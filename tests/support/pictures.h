// Pictures of real surfaces, read as the program reads them.
#pragma once

#include <string>

#include "host/video/codec/codec.h"
#include "host/video/frame_source.h"
#include "tests/support/data.h"

namespace impactdic::testing {

// `file` lies in the folder of real data.
inline Frame read_picture(const std::string& file) {
  video::VideoOptions options;
  options.open_codec = video::open_codec;
  const auto source = video::open_video({data_path(file).string()}, options);
  Frame frame;
  source->read(0, frame);
  return frame;
}

}  // namespace impactdic::testing
