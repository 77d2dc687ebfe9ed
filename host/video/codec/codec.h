// Containers and picture files through OpenCV: what needs a codec. The rest of the program asks
// host/video/codec_module.h for them.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "host/video/codec_module.h"

namespace impactdic::video {

// One container (.avi .mp4 .mov .mkv) or picture (.png .bmp .jpg .pgm). Of colour is read
// what OpenOptions::channel says.
// Containers give 8 bits; reads in order are fast, going back in a clip with inter-frame
// compression decodes it again from its start. Throws FileError, FormatError, the latter also for a
// picture above OpenOptions::max_megapixels.
std::unique_ptr<FrameSource> open_codec(const std::string& path, const OpenOptions& options = {});

// SinkFormat::kPng (`path` is a folder), avi (lossless FFV1), mp4 (lossy).
// Throws InvalidArgument (more than 8 bits for a container), FileError.
std::unique_ptr<FrameSink> open_codec_sink(const std::string& path, SinkFormat format,
                                           const ClipInfo& info);

// A colour MP4 for looking at: H.264 where FFmpeg has an encoder, else VP9, both 4:2:0, which
// browsers play; else MPEG-4. Width and height must be even.
class Mp4Writer : public ColourSink {
 public:
  // Throws FileError where the encoder or the disk refuses, InvalidArgument for an odd size.
  Mp4Writer(const std::string& path, int width, int height, double fps);
  ~Mp4Writer() override;
  Mp4Writer(const Mp4Writer&) = delete;
  Mp4Writer& operator=(const Mp4Writer&) = delete;
  void write(const std::uint8_t* bgr, std::ptrdiff_t pitch) override;
  void finish() override;

 private:
  struct Encoder;
  std::unique_ptr<Encoder> encoder_;
};

}  // namespace impactdic::video
