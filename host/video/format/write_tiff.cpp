// Multi-page TIFF, uncompressed, one strip a page; BigTIFF where the clip may exceed 4 GB.
#include <impactdic/error.h>
#include <tiffio.h>

#include <cstdarg>
#include <filesystem>

#include "host/video/description.h"
#include "host/video/format/writers.h"

namespace impactdic::video {
namespace {

int keep_message(TIFF*, void* text, const char*, const char* format, va_list arguments) {
  char line[400];
  std::vsnprintf(line, sizeof line, format, arguments);
  *static_cast<std::string*>(text) = line;
  return 1;
}

class TiffSink : public FrameSink {
 public:
  TiffSink(const std::string& path, const ClipInfo& info) : info_(info) {
    constexpr std::int64_t kClassicLimit = 4000000000;
    const std::int64_t frame_bytes = std::int64_t{info.width} * info.height * 2;
    const bool big = frame_bytes * std::max<std::int64_t>(info.frame_count, 1) > kClassicLimit;
    TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
    TIFFOpenOptionsSetErrorHandlerExtR(options, keep_message, &error_);
    handle_ = TIFFOpenExt(path.c_str(), big ? "w8" : "w", options);
    TIFFOpenOptionsFree(options);
    if (handle_ == nullptr) throw FileError("cannot write the file", path, error_);
  }

  ~TiffSink() override {
    if (handle_ == nullptr) return;
    TIFFClose(handle_);
    std::error_code ignored;
    std::filesystem::remove(info_.path, ignored);
  }

  void write(const Frame& frame) override {
    check_frame(frame, info_);
    const auto width = static_cast<std::uint32_t>(info_.width);
    const auto height = static_cast<std::uint32_t>(info_.height);
    TIFFSetField(handle_, TIFFTAG_IMAGEWIDTH, width);
    TIFFSetField(handle_, TIFFTAG_IMAGELENGTH, height);
    TIFFSetField(handle_, TIFFTAG_BITSPERSAMPLE, info_.bits <= 8 ? 8 : 16);
    TIFFSetField(handle_, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(handle_, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    TIFFSetField(handle_, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(handle_, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
    TIFFSetField(handle_, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
    TIFFSetField(handle_, TIFFTAG_ROWSPERSTRIP, height);
    if (first_) TIFFSetField(handle_, TIFFTAG_IMAGEDESCRIPTION, describe(info_).c_str());
    if (first_ && !info_.camera.empty()) {
      TIFFSetField(handle_, TIFFTAG_MODEL, info_.camera.c_str());
    }
    first_ = false;
    // libtiff does not change the pixels; its interface is older than const.
    void* pixels = const_cast<void*>(frame.bytes());
    const auto bytes = static_cast<tmsize_t>(frame.byte_count());
    if (TIFFWriteEncodedStrip(handle_, 0, pixels, bytes) != bytes ||
        TIFFWriteDirectory(handle_) != 1) {
      throw FileError("cannot write the file", info_.path, error_);
    }
  }

  void finish() override {
    if (handle_ == nullptr) return;
    error_.clear();
    TIFFClose(handle_);
    handle_ = nullptr;
    if (!error_.empty()) throw FileError("cannot write the file", info_.path, error_);
  }

 private:
  ClipInfo info_;
  std::string error_;
  TIFF* handle_ = nullptr;
  bool first_ = true;
};

}  // namespace

std::unique_ptr<FrameSink> open_tiff_sink(const std::string& path, const ClipInfo& info) {
  return std::make_unique<TiffSink>(path, info);
}

}  // namespace impactdic::video
