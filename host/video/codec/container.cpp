#include "host/video/codec/container.h"

#include <impactdic/error.h>

#include <cmath>
#include <deque>
#include <mutex>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>
#include <optional>
#include <set>

#include "host/base/parse.h"
#include "host/video/byte_file.h"
#include "host/video/channel.h"
#include "host/video/codec/display_turn.h"
#include "host/video/codec/grey.h"
#include "host/video/file_kind.h"
#include "host/video/picture_size.h"

namespace impactdic::video {
namespace {

constexpr std::size_t kKept = 16;  // decoded frames that stay at hand

// OpenCV gives whole numbers as doubles; what is none of 48 bits is 0.
std::int64_t whole(double value) {
  return std::abs(value) < 0x1p48 ? static_cast<std::int64_t>(value) : 0;
}

std::string code_name(std::int64_t fourcc) {
  std::string name;
  for (int i = 0; i < 4; ++i) {
    const char c = static_cast<char>(fourcc >> (8 * i) & 0xff);
    name += c > 32 && c < 127 ? c : ' ';
  }
  return trim(name);
}

// Codecs whose frames stand alone: a seek to one of them is exact.
bool is_intra_only(const std::string& code) {
  static const std::set<std::string> kIntra = {"rawv", "Y800", "GREY", "Y8", "FFV1",
                                               "HFYU", "MJPG", "DIB",  "",   "mjpg"};
  return kIntra.contains(code);
}
bool is_lossless(const std::string& code) {
  return is_intra_only(code) && code != "MJPG" && code != "mjpg";
}

// A decoder that goes forward, with the last frames kept: threads that share a clip ask for its
// frames nearly but not exactly in order.
class ContainerSource : public FrameSource {
 public:
  ContainerSource(const std::string& path, const OpenOptions& options)
      : max_megapixels_(options.max_megapixels), channel_(options.channel) {
    info_.path = path;
    turns_ = display_quarter_turns(ByteFile(path));
    open_decoder();
    fill_info();
  }

  const ClipInfo& info() const override { return info_; }

  void read(std::int64_t index, Frame& frame) override {
    check_frame_index(info_.path, index, info_.frame_count);
    const std::lock_guard lock(mutex_);
    try {
      frame = decoded(index);
    } catch (const cv::Exception& error) {
      throw FormatError(info_.path, -1, "the clip cannot be decoded", error.err);
    }
  }

 private:
  struct Decoded {
    std::int64_t index;
    Frame frame;
  };

  void open_decoder() {
    silence_codecs();
    try {
      // "file:" keeps a colon in the name from being taken for a protocol.
      capture_.open("file:" + info_.path, cv::CAP_FFMPEG);
    } catch (const cv::Exception& error) {
      throw FormatError(info_.path, -1, "the container cannot be read", error.err);
    }
    if (!capture_.isOpened()) {
      throw FormatError(info_.path, -1, "the container cannot be read",
                        "it is damaged, or its codec is not installed");
    }
    // OpenCV turns pictures that are to be shown on their side, in some versions the wrong way.
    if (turns_) capture_.set(cv::CAP_PROP_ORIENTATION_AUTO, 0);
    next_ = 0;
  }

  void fill_info() {
    const std::string code = code_name(whole(capture_.get(cv::CAP_PROP_FOURCC)));
    intra_only_ = is_intra_only(code);
    info_.format = lower_extension(info_.path) == ".avi" ? "AVI" : "video container";
    info_.storage = "8-bit, " + (code.empty() ? "uncompressed" : code);
    const std::int64_t width = whole(capture_.get(cv::CAP_PROP_FRAME_WIDTH));
    const std::int64_t height = whole(capture_.get(cv::CAP_PROP_FRAME_HEIGHT));
    if (width < 1 || height < 1) {
      throw FormatError(info_.path, -1, "the container does not say how large its pictures are",
                        "it is damaged, or holds no pictures");
    }
    check_frame_size(info_.path, width, height, 3);
    check_megapixels(info_.path, width, height, max_megapixels_);
    info_.width = static_cast<int>(on_its_side() ? height : width);
    info_.height = static_cast<int>(on_its_side() ? width : height);
    info_.bits = 8;
    count_frames();
    if (turns_.value_or(0) != 0) {
      info_.warnings.push_back("the pictures are turned by " + std::to_string(90 * *turns_) +
                               " degrees clockwise, as the film says it is to be shown");
    }
    warn_of_aspect();
    info_.lossy = !is_lossless(code);
    if (info_.lossy) {
      info_.warnings.push_back("lossy compression (" + code + "): grey levels are not exact");
    }
    const double fps = capture_.get(cv::CAP_PROP_FPS);
    if (std::isfinite(fps) && fps > 0) info_.fps = fps;
    // 600 1/s is what a common writer puts into AVI for anything faster.
    if (!info_.fps || *info_.fps < 500 || *info_.fps == 600) {
      info_.warnings.push_back(
          "the container states " + shortest(info_.fps.value_or(0)) +
          " frames/s, at which a high-speed clip is played, not recorded: give "
          "the camera's rate with --fps");
    }
    const cv::Mat first = grab_next();
    if (is_colored(first)) info_.warnings.push_back(colour_warning(channel_));
    keep(first);
  }

  // Of analogue video, and of what some converters write.
  void warn_of_aspect() {
    const double wide = capture_.get(cv::CAP_PROP_SAR_NUM);
    const double high = capture_.get(cv::CAP_PROP_SAR_DEN);
    if (!(wide > 0 && high > 0) || wide == high) return;
    info_.warnings.push_back("its pixels are not square but " + shortest(wide) + ":" +
                             shortest(high) +
                             ", wide to high: lengths along rows and columns differ; make them "
                             "square first (ffmpeg -vf scale=iw*sar:ih,setsar=1)");
  }

  // Matroska does not store the number of frames: there they are counted once.
  void count_frames() {
    const ByteFile file(info_.path);
    const bool counted = load_u32(file.bytes_at(0, 4).data()) != 0xa3df451au;
    const double stated = capture_.get(cv::CAP_PROP_FRAME_COUNT);
    if (counted && stated >= 1 && stated < 1e9) {
      info_.frame_count = std::llround(stated);
      return;
    }
    while (capture_.grab()) ++info_.frame_count;
    if (info_.frame_count == 0) throw FormatError(info_.path, -1, "the clip holds no frames");
    open_decoder();
  }

  bool on_its_side() const { return turns_.value_or(0) % 2 == 1; }

  cv::Mat grab_next() {
    cv::Mat picture;
    if (!capture_.read(picture) || picture.empty()) {
      throw FormatError(info_.path, -1, "frame " + std::to_string(next_) + " cannot be decoded",
                        "the container states " + std::to_string(info_.frame_count) +
                            " frames; was it copied whole?");
    }
    if (turns_.value_or(0) != 0) {
      constexpr int kTurns[] = {cv::ROTATE_90_CLOCKWISE, cv::ROTATE_180,
                                cv::ROTATE_90_COUNTERCLOCKWISE};
      cv::Mat turned;
      cv::rotate(picture, turned, kTurns[*turns_ - 1]);
      picture = turned;
    }
    if (picture.cols != info_.width || picture.rows != info_.height) {
      throw FormatError(info_.path, -1, "the picture size changes within the clip");
    }
    return picture;
  }

  const Frame& keep(const cv::Mat& picture) {
    Decoded entry;
    if (kept_.size() == kKept) {
      entry = std::move(kept_.front());
      kept_.pop_front();
    }
    entry.index = next_++;
    to_frame(picture, info_.path, channel_, entry.frame);
    kept_.push_back(std::move(entry));
    return kept_.back().frame;
  }

  const Frame& decoded(std::int64_t index) {
    for (const Decoded& entry : kept_) {
      if (entry.index == index) return entry.frame;
    }
    const auto near = static_cast<std::int64_t>(kKept);
    if (index < next_ || (intra_only_ && index >= next_ + near)) go_to(index);
    while (next_ + near <= index) {
      if (!capture_.grab()) break;  // the read below says what is missing
      ++next_;
    }
    const Frame* frame = nullptr;
    while (next_ <= index) frame = &keep(grab_next());
    return *frame;
  }

  // Exact whatever the codec: back to the start, unless frames stand alone.
  void go_to(std::int64_t index) {
    kept_.clear();
    if (intra_only_ && capture_.set(cv::CAP_PROP_POS_FRAMES, static_cast<double>(index)) &&
        std::llround(capture_.get(cv::CAP_PROP_POS_FRAMES)) == index) {
      next_ = index;
      return;
    }
    open_decoder();
  }

  double max_megapixels_;
  Channel channel_;
  ClipInfo info_;
  std::mutex mutex_;
  cv::VideoCapture capture_;
  std::optional<int> turns_;  // quarters clockwise; unknown: left to OpenCV
  bool intra_only_ = false;
  std::int64_t next_ = 0;  // the frame that the decoder gives next
  std::deque<Decoded> kept_;
};

}  // namespace

std::unique_ptr<FrameSource> open_container(const std::string& path, const OpenOptions& options) {
  return std::make_unique<ContainerSource>(path, options);
}

}  // namespace impactdic::video
