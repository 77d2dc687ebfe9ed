// Writers of clips: the counterpart of FrameSource, for synthetic clips, overlays and tests.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "host/video/frame_source.h"

namespace impactdic::video {

enum class SinkFormat {
  kTiff,          // multi-page, uncompressed, 8 or 16 bits
  kRaw,           // bare pixels, 8 or 16 bits little-endian
  kCine,          // Phantom, 8 or 16 bits
  kCinePacked10,  // 10-bit codes; 12-bit frames go through the camera's transfer curve (lossy)
  kCinePacked12,  // 12 bits packed
  kMraw,          // Photron .mraw with .cihx, 8 or 16 bits
  kMrawPacked12,  // 12 bits packed
  kPng,           // one file a frame in a folder, 8 or 16 bits; needs the codecs
  kAvi,           // lossless 8 bits; needs the codecs
  kMp4,           // lossy 8 bits, for looking at; needs the codecs
};

// "tiff", "raw", "cine", "cine10", "cine12", "mraw", "mraw12", "png", "avi", "mp4".
// Throws InvalidArgument.
SinkFormat parse_sink_format(const std::string& text);
// ".tif", ".raw", ".cine", ".mraw", "" (a folder), ".avi", ".mp4".
std::string sink_extension(SinkFormat format);

class FrameSink {
 public:
  virtual ~FrameSink() = default;
  // Appends a frame. Throws InvalidArgument where its size or depth is not the clip's, FileError
  // where the disk refuses.
  virtual void write(const Frame& frame) = 0;
  // Completes the file. A sink destroyed without it leaves no usable file behind.
  virtual void finish() = 0;
};

// Starts a clip. Of `info` are used: width, height, bits (depth of the frames: 8 stored bits up to
// 8, else 16), fps, exposure_s, frame_count (needed by cine, whose frame table comes first),
// first_frame_number, camera.
// Throws InvalidArgument (impossible depth, codec missing) or FileError.
std::unique_ptr<FrameSink> open_sink(const std::string& path, SinkFormat format,
                                     const ClipInfo& info);

// Throws InvalidArgument unless the frame has the clip's size and depth.
void check_frame(const Frame& frame, const ClipInfo& info);

}  // namespace impactdic::video
