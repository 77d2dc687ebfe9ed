#include "host/video/frame_sink.h"

#include <impactdic/error.h>

#include <cerrno>
#include <cstring>
#include <map>
#include <utility>

#include "host/video/byte_file.h"
#include "host/video/codec_module.h"
#include "host/video/format/writers.h"

namespace impactdic::video {

SinkFormat parse_sink_format(const std::string& text) {
  static const std::map<std::string, SinkFormat> kFormats = {{"tiff", SinkFormat::kTiff},
                                                             {"raw", SinkFormat::kRaw},
                                                             {"cine", SinkFormat::kCine},
                                                             {"cine10", SinkFormat::kCinePacked10},
                                                             {"cine12", SinkFormat::kCinePacked12},
                                                             {"mraw", SinkFormat::kMraw},
                                                             {"mraw12", SinkFormat::kMrawPacked12},
                                                             {"png", SinkFormat::kPng},
                                                             {"avi", SinkFormat::kAvi},
                                                             {"mp4", SinkFormat::kMp4}};
  const auto found = kFormats.find(text);
  if (found == kFormats.end()) {
    throw InvalidArgument("\"" + text + "\" is no format to write", "--format",
                          "tiff, raw, cine, cine10, cine12, mraw, mraw12, png, avi or mp4");
  }
  return found->second;
}

std::string sink_extension(SinkFormat format) {
  switch (format) {
    case SinkFormat::kTiff:
      return ".tif";
    case SinkFormat::kRaw:
      return ".raw";
    case SinkFormat::kCine:
    case SinkFormat::kCinePacked10:
    case SinkFormat::kCinePacked12:
      return ".cine";
    case SinkFormat::kMraw:
    case SinkFormat::kMrawPacked12:
      return ".mraw";
    case SinkFormat::kPng:
      return "";
    case SinkFormat::kAvi:
      return ".avi";
    case SinkFormat::kMp4:
      return ".mp4";
  }
  return "";
}

void check_frame(const Frame& frame, const ClipInfo& info) {
  if (frame.width() != info.width || frame.height() != info.height) {
    throw InvalidArgument("a frame of " + std::to_string(frame.width()) + " x " +
                              std::to_string(frame.height()) + " pixels for a clip of " +
                              std::to_string(info.width) + " x " + std::to_string(info.height),
                          info.path);
  }
  if (frame.bits != info.bits || (frame.type == PixelType::kU8) != (frame.bits <= 8)) {
    throw InvalidArgument("a frame of " + std::to_string(frame.bits) + " bits for a clip of " +
                              std::to_string(info.bits),
                          info.path);
  }
}

std::unique_ptr<FrameSink> open_sink(const std::string& path, SinkFormat format,
                                     const ClipInfo& asked) {
  ClipInfo info = asked;
  info.path = path;
  if (info.bits < 1 || info.bits > 16) {
    throw InvalidArgument("no clip of " + std::to_string(info.bits) + " bits", path, "1 to 16");
  }
  check_frame_size(path, info.width, info.height, 2);
  const Packing plain = info.bits <= 8 ? Packing::kU8 : Packing::kU16;
  switch (format) {
    case SinkFormat::kTiff:
      return open_tiff_sink(path, info);
    case SinkFormat::kRaw:
      return open_raw_sink(path, info);
    case SinkFormat::kCine:
      return open_cine_sink(path, plain, info);
    case SinkFormat::kCinePacked10:
      return open_cine_sink(path, Packing::kPacked10, info);
    case SinkFormat::kCinePacked12:
      return open_cine_sink(path, Packing::kPacked12, info);
    case SinkFormat::kMraw:
      return open_mraw_sink(path, plain, info);
    case SinkFormat::kMrawPacked12:
      return open_mraw_sink(path, Packing::kPacked12, info);
    case SinkFormat::kPng:
    case SinkFormat::kAvi:
    case SinkFormat::kMp4:
      break;
  }
  return codec_module(path, "tiff, raw, cine and mraw are written").open_sink(path, format, info);
}

OutputFile::OutputFile(const std::string& path) : path_(path) {
  file_ = std::fopen(path.c_str(), "wb");
  if (file_ == nullptr) throw FileError("cannot write the file", path, std::strerror(errno));
}

OutputFile::~OutputFile() {
  if (file_ == nullptr) return;
  std::fclose(file_);
  std::remove(path_.c_str());
}

void OutputFile::append(const void* bytes, std::size_t count) {
  if (std::fwrite(bytes, 1, count, file_) != count) {
    throw FileError("cannot write the file", path_, std::strerror(errno));
  }
}

void OutputFile::finish() {
  if (file_ == nullptr) return;
  if (std::fflush(file_) != 0) {
    throw FileError("cannot write the file", path_, std::strerror(errno));
  }
  std::FILE* file = std::exchange(file_, nullptr);
  if (std::fclose(file) != 0) {
    throw FileError("cannot write the file", path_, std::strerror(errno));
  }
}

void pack_frame(const Frame& frame, Packing packing, bool bottom_up,
                std::vector<std::uint8_t>& stored) {
  const auto width = static_cast<std::size_t>(frame.width());
  const int height = frame.height();
  stored.resize(
      static_cast<std::size_t>(packed_bytes(packing, std::int64_t{frame.width()} * height)));
  const auto from = [&](int y) { return bottom_up ? height - 1 - y : y; };
  if (packing == Packing::kU8) {
    for (int y = 0; y < height; ++y) {
      std::memcpy(stored.data() + static_cast<std::size_t>(y) * width, frame.u8.row(from(y)),
                  width);
    }
    return;
  }
  if (packing == Packing::kU16) {
    for (int y = 0; y < height; ++y) {
      pack_16(frame.u16.row(from(y)), width,
              stored.data() + 2 * static_cast<std::size_t>(y) * width);
    }
    return;
  }
  // Packed pixels run on from row to row, always from the top.
  const auto pack = packing == Packing::kPacked10 ? pack_10 : pack_12;
  pack(frame.u16.data(), frame.u16.size(), stored.data());
}

}  // namespace impactdic::video
