#include "host/video/levels/even_lines.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace impactdic::video {
namespace {

// v less the pattern is v * factor - shift, to the first order in the pattern.
struct Line {
  float factor = 1, shift = 0;
};

std::vector<Line> lines_of(const LinePattern& pattern, int count) {
  std::vector<Line> lines(static_cast<std::size_t>(count));
  if (pattern.offset.empty()) return lines;
  if (pattern.offset.size() != lines.size() || pattern.gain.size() != lines.size()) {
    throw InvalidArgument("a sensor's pattern has another size than its pictures");
  }
  for (std::size_t k = 0; k < lines.size(); ++k) {
    lines[k].factor = 1 - pattern.gain[k];
    lines[k].shift = pattern.offset[k] - pattern.gain[k] * static_cast<float>(pattern.level);
  }
  return lines;
}

class EvenLines : public FrameSource {
 public:
  EvenLines(std::shared_ptr<FrameSource> source, const SensorPattern& pattern)
      : source_(std::move(source)),
        info_(source_->info()),
        columns_(lines_of(pattern.columns, info_.width)),
        rows_(lines_of(pattern.rows, info_.height)),
        full_(static_cast<float>((1u << info_.bits) - 1)) {
    if (info_.bits <= 8) info_.bits = 16;
    by_ = static_cast<float>((1u << info_.bits) - 1) / full_;
    info_.extra.emplace_back("grey levels", "less the pattern of the sensor's columns and rows");
  }

  const ClipInfo& info() const override { return info_; }
  void read(std::int64_t index, Frame& frame) override {
    thread_local Frame as_stored;  // memory only
    source_->read(index, as_stored);
    frame.reset(as_stored.width(), as_stored.height(), info_.bits);
    if (as_stored.type == PixelType::kU8) {
      turn(as_stored.u8, frame.u16);
    } else {
      turn(as_stored.u16, frame.u16);
    }
  }
  std::optional<double> frame_time_s(std::int64_t index) override {
    return source_->frame_time_s(index);
  }
  std::optional<double> frame_exposure_s(std::int64_t index) override {
    return source_->frame_exposure_s(index);
  }

 private:
  template <typename T>
  void turn(const Image<T>& stored, Image<std::uint16_t>& to) const {
    for (int y = 0; y < stored.height(); ++y) {
      const T* from = stored.row(y);
      std::uint16_t* out = to.row(y);
      const Line row = rows_[static_cast<std::size_t>(y)];
      for (int x = 0; x < stored.width(); ++x) {
        const Line& column = columns_[static_cast<std::size_t>(x)];
        const auto level = static_cast<float>(from[x]);
        const float even = (level * column.factor - column.shift) * row.factor - row.shift;
        const float kept = level <= 0 || level >= full_ ? level : std::clamp(even, 0.0f, full_);
        out[x] = static_cast<std::uint16_t>(std::lround(kept * by_));
      }
    }
  }

  std::shared_ptr<FrameSource> source_;
  ClipInfo info_;
  std::vector<Line> columns_, rows_;
  float full_, by_;  // the stored scale's end, and levels given to one stored
};

}  // namespace

std::shared_ptr<FrameSource> even_lines(std::shared_ptr<FrameSource> source,
                                        const SensorPattern& pattern) {
  return std::make_shared<EvenLines>(std::move(source), pattern);
}

}  // namespace impactdic::video
