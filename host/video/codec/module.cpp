// The one symbol that the module shows.
#include "host/video/codec/codec.h"

namespace impactdic::video {
namespace {

std::unique_ptr<ColourSink> open_mp4(const std::string& path, int width, int height, double fps) {
  return std::make_unique<Mp4Writer>(path, width, height, fps);
}

}  // namespace
}  // namespace impactdic::video

extern "C" __attribute__((visibility("default")))
const impactdic::video::CodecModule impactdic_codec_module = {
    IMPACTDIC_VERSION, impactdic::video::open_codec, impactdic::video::open_codec_sink,
    impactdic::video::open_mp4};
