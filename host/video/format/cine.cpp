// Phantom .cine: random access to grey frames with the camera's own times.
#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numeric>

#include "host/base/parse.h"
#include "host/base/statistics.h"
#include "host/video/format/cine_header.h"
#include "host/video/format/readers.h"

namespace impactdic::video {
namespace {

constexpr double kTicksPerSecond = 4294967296.0;   // 2^32
constexpr double kStampsPerSecond = 1073741824.0;  // 2^30: the two lowest bits are flags

// "2015-07-24T20:47:01.123456Z".
std::string iso_utc(std::uint64_t ticks) {
  const std::time_t seconds = static_cast<std::time_t>(ticks >> 32);
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  char date[32], text[48];
  std::strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%S", &parts);
  const int micro = static_cast<int>((ticks & 0xffffffffu) / kTicksPerSecond * 1e6);
  std::snprintf(text, sizeof text, "%s.%06dZ", date, micro);
  return text;
}

class CineSource : public FrameSource {
 public:
  CineSource(const std::string& path, bool phantom_codes, bool lend)
      : file_(path, lend), header_(read_cine_header(file_)) {
    linearise_ = header_.packing == Packing::kPacked10 && !phantom_codes;
    fill_info();
    compare_rate_with_times();
  }

  const ClipInfo& info() const override { return info_; }

  void read(std::int64_t index, Frame& frame) override {
    check_frame_index(info_.path, index, info_.frame_count);
    const std::int64_t at = pixels_at(index);
    const auto bytes = static_cast<std::size_t>(header_.frame_bytes);
    if (!read_frame(file_, at, bytes, header_.packing, info_.width, info_.height, header_.bits, 0,
                    header_.bottom_up, frame)) {
      throw FormatError(info_.path, at,
                        "a pixel is brighter than the " + std::to_string(header_.bits) +
                            " bits that the header states");
    }
    if (linearise_) {
      linearise_10(frame.u16.data(), frame.u16.size());
      frame.bits = 12;
    }
  }

  std::optional<double> frame_time_s(std::int64_t index) override {
    check_frame_index(info_.path, index, info_.frame_count);
    if (!info_.has_timestamps) return std::nullopt;
    return static_cast<double>(stamp(index) - stamp(0)) / kStampsPerSecond;
  }

  std::optional<double> frame_exposure_s(std::int64_t index) override {
    check_frame_index(info_.path, index, info_.frame_count);
    if (!header_.exposures || index >= header_.exposures->frames) return std::nullopt;
    return load_u32(file_.bytes_at(header_.exposures->offset + 4 * index, 4).data()) /
           kTicksPerSecond;
  }

 private:
  // The frame's own annotation says where its pixels begin.
  std::int64_t pixels_at(std::int64_t index) const {
    const std::int64_t at = load_i64(file_.bytes_at(header_.offset_table + 8 * index, 8).data());
    if (!header_.annotated) return at;
    const std::int64_t annotation = load_u32(file_.bytes_at(at, 4).data());
    if (annotation < 8 || !file_.holds(at, annotation + header_.frame_bytes)) {
      throw FormatError(info_.path, at,
                        "frame " + std::to_string(index) + " has a damaged annotation");
    }
    const std::uint32_t size = load_u32(file_.bytes_at(at + annotation - 4, 4).data());
    if (size != header_.frame_bytes) {
      throw FormatError(info_.path, at + annotation - 4,
                        "frame " + std::to_string(index) + " has " + std::to_string(size) +
                            " bytes where " + std::to_string(header_.frame_bytes) +
                            " are expected");
    }
    return at + annotation;
  }

  // A time stamp in 2^-30 s since 1970; the difference of any two cannot overflow.
  static std::int64_t stamp_of(const std::uint8_t* bytes) {
    return static_cast<std::int64_t>(load_u64(bytes) >> 2);
  }
  std::int64_t stamp(std::int64_t index) const {
    return stamp_of(file_.bytes_at(header_.times->offset + 8 * index, 8).data());
  }

  void fill_info() {
    info_.path = file_.path();
    info_.format = "Phantom cine";
    info_.camera = header_.model;
    info_.storage = packing_name(header_.packing);
    info_.width = header_.width;
    info_.height = header_.height;
    info_.bits = linearise_ ? 12 : header_.bits;
    info_.frame_count = header_.frame_count;
    info_.first_frame_number = header_.first_frame_number;
    info_.fps = header_.fps;
    info_.exposure_s = header_.exposure_s;
    info_.warnings = header_.warnings;
    if (header_.trigger_time >> 32 != 0) info_.recorded_at = iso_utc(header_.trigger_time);
    info_.has_timestamps = header_.times && header_.times->frames >= header_.frame_count;
    const auto add = [this](const char* name, const auto& value) {
      if (value) info_.extra.emplace_back(name, std::to_string(*value));
    };
    if (linearise_) info_.extra.emplace_back("pixels", "10-bit codes linearised to 12 bits");
    add("serial", header_.serial);
    add("camera_version", header_.camera_version);
    add("recorded_frames", std::optional(header_.recorded_frames));
    add("post_trigger_frames", header_.post_trigger);
    add("black_level", header_.black_level);
    add("white_level", header_.white_level);
  }

  // Stamps of `count` frames from `start` on.
  std::vector<std::int64_t> stamps(std::int64_t start, std::int64_t count) const {
    const auto bytes =
        file_.bytes_at(header_.times->offset + 8 * start, static_cast<std::size_t>(8 * count));
    std::vector<std::int64_t> values(static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = stamp_of(&bytes[8 * i]);
    return values;
  }

  // The usual interval of the first stamps, s, and how far it may be off because a camera stamps
  // whole microseconds. Their mean: intervals of 28.5 µs are stamped as 28 and 29. A pause, which
  // is far from the median, does not count.
  struct Interval {
    double s = 0, off_s = 0;
  };
  Interval usual_interval() const {
    constexpr double kGrid_s = 1e-6, kUsual = 0.5;
    auto intervals = stamps(0, std::min<std::int64_t>(info_.frame_count, 1001));
    std::adjacent_difference(intervals.begin(), intervals.end(), intervals.begin());
    intervals.erase(intervals.begin());  // no difference
    const auto median = static_cast<double>(upper_median(intervals));
    double sum = 0;
    int n = 0;
    for (const std::int64_t interval : intervals) {
      const auto one = static_cast<double>(interval);
      if (std::abs(one - median) > kUsual * median) continue;
      sum += one;
      ++n;
    }
    if (n == 0) return {};
    return {sum / n / kStampsPerSecond, kGrid_s / n};
  }

  // The first frame whose stamp lies before its neighbour's or absurdly far after it; −1: none.
  std::int64_t first_wrong_stamp(double interval_s) const {
    constexpr std::int64_t kChunk = 8192;
    const double longest = 1000 * interval_s * kStampsPerSecond;
    std::int64_t previous = stamp(0);
    for (std::int64_t start = 1; start < info_.frame_count; start += kChunk) {
      const auto chunk = stamps(start, std::min(kChunk, info_.frame_count - start));
      for (std::size_t i = 0; i < chunk.size(); ++i) {
        if (chunk[i] <= previous || static_cast<double>(chunk[i] - previous) > longest) {
          return start + static_cast<std::int64_t>(i);
        }
        previous = chunk[i];
      }
    }
    return -1;
  }

  // A file may hold every k-th frame of a recording; only the time stamps tell.
  void compare_rate_with_times() {
    if (!info_.has_timestamps || info_.frame_count < 2) return;
    const auto [interval_s, off_s] = usual_interval();
    const std::int64_t wrong = interval_s > 0 ? first_wrong_stamp(interval_s) : 1;
    if (wrong >= 0) {
      info_.has_timestamps = false;
      info_.warnings.push_back("the time stamp of frame " + std::to_string(wrong) +
                               " is wrong: the stamps are ignored");
    }
    if (!(interval_s > 0)) return;
    const double measured = 1 / interval_s;
    if (!info_.fps) {
      info_.fps = measured;
      info_.warnings.push_back("the frame rate is taken from the time stamps");
      return;
    }
    const double step = *info_.fps / measured;
    if (std::abs(step - 1) < 0.01 + off_s / interval_s) return;
    if (step > 1.5 && step < 1e9 && std::abs(step - std::round(step)) < 0.01 + 1e-4 * step) {
      info_.record_step = std::llround(step);
      *info_.fps /= static_cast<double>(info_.record_step);
      return;
    }
    info_.warnings.push_back("the header states " + shortest(*info_.fps) +
                             " frames/s, the time stamps " + shortest(measured));
  }

  ByteFile file_;
  CineHeader header_;
  bool linearise_ = false;
  ClipInfo info_;
};

}  // namespace

std::unique_ptr<FrameSource> open_cine(const std::string& path, bool phantom_codes, bool lend) {
  return std::make_unique<CineSource>(path, phantom_codes, lend);
}

}  // namespace impactdic::video
