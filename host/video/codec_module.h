// The codecs, loaded when a file first asks for one: the libraries behind them are two hundred, and
// take the program longer to load than all the rest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "host/video/frame_sink.h"
#include "host/video/frame_source.h"

namespace impactdic::video {

// A colour video for looking at, such as an overlay.
class ColourSink {
 public:
  virtual ~ColourSink() = default;
  // `bgr`: (height, width, 3) bytes: blue, green, red; `pitch` bytes from row to row.
  // Throws FileError where the disk refuses.
  virtual void write(const std::uint8_t* bgr, std::ptrdiff_t pitch) = 0;
  // Completes the file; throws FileError where it is not there afterwards. A sink destroyed without
  // it leaves no file behind.
  virtual void finish() = 0;
};

// What the module host/video/codec gives; codec/codec.h says what each does and throws.
struct CodecModule {
  const char* version;  // of the program that it was built with
  std::unique_ptr<FrameSource> (*open)(const std::string& path, const OpenOptions& options);
  std::unique_ptr<FrameSink> (*open_sink)(const std::string& path, SinkFormat format,
                                          const ClipInfo& info);
  std::unique_ptr<ColourSink> (*open_mp4)(const std::string& path, int width, int height,
                                          double fps);
};

// Whether the program was built with codecs.
bool has_codecs();

// The module, loaded at the first call; it stays. The dynamic linker looks for it in the RUNPATH of
// whoever holds this function. `path` is the file that needs it, `instead` what else a user can do.
// Throws InvalidArgument where the program was built without codecs, FileError where the module
// cannot be loaded or is of another version.
const CodecModule& codec_module(const std::string& path, const std::string& instead);

}  // namespace impactdic::video
