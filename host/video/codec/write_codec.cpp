// Clips as PNG files, lossless AVI and MP4.
#include <impactdic/error.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "host/video/codec/codec.h"
#include "host/video/codec/grey.h"

namespace impactdic::video {
namespace {

namespace fs = std::filesystem;

class PngSink : public FrameSink {
 public:
  PngSink(const std::string& folder, const ClipInfo& info) : info_(info) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) throw FileError("cannot make the folder", folder, error.message());
  }
  void write(const Frame& frame) override {
    check_frame(frame, info_);
    char name[40];
    std::snprintf(name, sizeof name, "frame_%06lld.png", static_cast<long long>(written_++));
    const std::string path = (fs::path(info_.path) / name).string();
    bool done = false;
    try {
      done = cv::imwrite(path, as_mat(frame), {cv::IMWRITE_PNG_COMPRESSION, 1});
    } catch (const cv::Exception& error) {
      throw FileError("cannot write the file", path, error.err);
    }
    if (!done) throw FileError("cannot write the file", path);
  }
  void finish() override {}

 private:
  ClipInfo info_;
  std::int64_t written_ = 0;
};

// An encoder that leaves no file behind unless finished.
class Encoder {
 public:
  Encoder(const std::string& path, const char* fourcc, int width, int height, double fps,
          bool color)
      : path_(path) {
    silence_codecs();
    const int code = cv::VideoWriter::fourcc(fourcc[0], fourcc[1], fourcc[2], fourcc[3]);
    try {
      writer_.open(path, cv::CAP_FFMPEG, code, fps, cv::Size(width, height), color);
    } catch (const cv::Exception& error) {
      throw FileError("cannot write the file", path, error.err);
    }
    if (!writer_.isOpened()) {
      throw FileError("cannot write the file", path, "the encoder refuses it, or the folder");
    }
  }
  ~Encoder() {
    if (!writer_.isOpened()) return;
    writer_.release();
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;

  void write(const cv::Mat& picture) {
    try {
      writer_.write(picture);
    } catch (const cv::Exception& error) {
      throw FileError("cannot write the file", path_, error.err);
    }
  }
  void finish() {
    writer_.release();
    std::error_code error;
    if (fs::file_size(path_, error) == 0 || error) {
      throw FileError("cannot write the file", path_, "nothing was stored: is the disk full?");
    }
  }

 private:
  std::string path_;
  cv::VideoWriter writer_;
};

// FFmpeg's AVI writer cannot state more than 600 frames/s and then miscounts the frames. The clip
// is encoded at a rate that it can, and the two places that state the rate get the true one
// (avih: microseconds a frame; strh: scale and rate).
constexpr double kEncodedAviRate = 25;

void state_avi_rate(const std::string& path, double fps) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  std::string head(4096, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  file.clear();
  const auto avih = head.find("avih"), strh = head.find("strh");
  if (avih == std::string::npos || strh == std::string::npos) {
    throw FileError("the AVI header is not where it should be", path);
  }
  const auto put = [&file](std::size_t at, double value) {
    const auto number = static_cast<std::uint32_t>(std::llround(value));
    char bytes[4];
    for (int i = 0; i < 4; ++i) bytes[i] = static_cast<char>(number >> (8 * i));
    file.seekp(static_cast<std::streamoff>(at));
    file.write(bytes, 4);
  };
  const double scale = fps == std::round(fps) ? 1 : 1000;
  put(avih + 8, 1e6 / fps);
  put(strh + 8 + 20, scale);
  put(strh + 8 + 24, fps * scale);
  if (!file.flush()) throw FileError("cannot write the file", path);
}

class ContainerSink : public FrameSink {
 public:
  ContainerSink(const std::string& path, const char* fourcc, const ClipInfo& info)
      : info_(info),
        is_avi_(fs::path(path).extension() == ".avi"),
        encoder_(path, fourcc, info.width, info.height,
                 is_avi_ ? kEncodedAviRate : info.fps.value_or(25), false) {}
  void write(const Frame& frame) override {
    check_frame(frame, info_);
    encoder_.write(as_mat(frame));
  }
  void finish() override {
    encoder_.finish();
    if (is_avi_ && info_.fps) state_avi_rate(info_.path, *info_.fps);
  }

 private:
  ClipInfo info_;
  bool is_avi_;
  Encoder encoder_;
};

}  // namespace

std::unique_ptr<FrameSink> open_codec_sink(const std::string& path, SinkFormat format,
                                           const ClipInfo& asked) {
  ClipInfo info = asked;
  info.path = path;
  if (format == SinkFormat::kPng) return std::make_unique<PngSink>(path, info);
  if (info.bits != 8) {
    throw InvalidArgument(
        "containers hold 8-bit frames, not " + std::to_string(info.bits) + "-bit ones", path,
        "tiff, png, cine and mraw hold them");
  }
  if (format == SinkFormat::kAvi) return std::make_unique<ContainerSink>(path, "FFV1", info);
  if (format != SinkFormat::kMp4) throw InvalidArgument("not a format of the codecs", path);
  if (info.width % 2 != 0 || info.height % 2 != 0) {
    throw InvalidArgument("an MP4 needs an even width and height", path);
  }
  return std::make_unique<ContainerSink>(path, "mp4v", info);
}

struct Mp4Writer::Encoder {
  std::unique_ptr<video::Encoder> file;
  int width = 0, height = 0;
};

Mp4Writer::Mp4Writer(const std::string& path, int width, int height, double fps) {
  if (width < 2 || height < 2 || width % 2 != 0 || height % 2 != 0) {
    throw InvalidArgument("an MP4 needs an even width and height", path);
  }
  encoder_ = std::make_unique<Encoder>();
  encoder_->width = width;
  encoder_->height = height;
  for (const char* code : {"avc1", "vp09"}) {
    try {
      encoder_->file = std::make_unique<video::Encoder>(path, code, width, height, fps, true);
      return;
    } catch (const FileError&) {  // this FFmpeg has no such encoder, or takes no such size
    }
  }
  encoder_->file = std::make_unique<video::Encoder>(path, "mp4v", width, height, fps, true);
}

Mp4Writer::~Mp4Writer() = default;

void Mp4Writer::write(const std::uint8_t* bgr, std::ptrdiff_t pitch) {
  encoder_->file->write(cv::Mat(encoder_->height, encoder_->width, CV_8UC3,
                                const_cast<std::uint8_t*>(bgr), static_cast<std::size_t>(pitch)));
}

void Mp4Writer::finish() { encoder_->file->finish(); }

}  // namespace impactdic::video
