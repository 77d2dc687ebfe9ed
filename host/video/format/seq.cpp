// Norpix StreamPix .seq: uncompressed grey frames of one size, each followed by its time. The
// layout is that of the manual's appendix as PIMS (norpix_reader.py) reads it;
// docs/file-formats.md.
#include <impactdic/error.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "host/video/byte_file.h"
#include "host/video/format/readers.h"
#include "host/video/unpack.h"

namespace impactdic::video {
namespace {

constexpr std::size_t kHeaderBytes = 1024;
constexpr std::uint32_t kMonochrome = 100;  // of the image formats
constexpr std::int32_t kNewVersion = 5;     // from here on frames begin later, times are finer

struct SeqHeader {
  std::int64_t first_frame = 0, frame_step = 0;  // bytes
  std::int64_t image_bytes = 0;
  std::int64_t time_bytes =
      0;  // of a frame's time: 4 of seconds, 2 of ms and, of new files, 2 of us
  int bits = 8;
  Packing packing = Packing::kU8;
};

class SeqSource : public FrameSource {
 public:
  SeqSource(const std::string& path, bool lend) : file_(path, lend) {
    if (file_.size() < static_cast<std::int64_t>(kHeaderBytes)) {
      throw FormatError(path, file_.size(), "the file ends within its header");
    }
    const auto bytes = file_.bytes_at(0, kHeaderBytes);
    read_layout(bytes);
    info_.path = path;
    info_.format = "Norpix seq";
    info_.storage = packing_name(header_.packing);
    info_.bits = header_.bits;
    info_.frame_count = frame_count(load_u32(&bytes[572]));
    const double rate = std::bit_cast<double>(load_u64(&bytes[584]));
    if (std::isfinite(rate) && rate > 0) info_.fps = rate;
    look_at_times();
  }

  const ClipInfo& info() const override { return info_; }

  void read(std::int64_t index, Frame& frame) override {
    check_frame_index(info_.path, index, info_.frame_count);
    const std::int64_t at = place(index);
    if (!read_frame(file_, at, static_cast<std::size_t>(header_.image_bytes), header_.packing,
                    info_.width, info_.height, info_.bits, 0, false, frame)) {
      throw FormatError(info_.path, at,
                        "a pixel is brighter than the " + std::to_string(info_.bits) +
                            " bits that the header states");
    }
  }

  std::optional<double> frame_time_s(std::int64_t index) override {
    check_frame_index(info_.path, index, info_.frame_count);
    if (!info_.has_timestamps) return std::nullopt;
    return static_cast<double>(time_us(index) - time_us(0)) * 1e-6;
  }

 private:
  void read_layout(const std::vector<std::uint8_t>& bytes) {
    const std::string& path = file_.path();
    const std::int64_t width = load_u32(&bytes[548]), height = load_u32(&bytes[552]);
    const std::uint32_t stored = load_u32(&bytes[556]), real = load_u32(&bytes[560]);
    check_frame_size(path, width, height, 2);
    if (const std::uint32_t format = load_u32(&bytes[568]); format != kMonochrome) {
      throw FormatError(path, 568, "the image format " + std::to_string(format) + " is not read",
                        "export the sequence uncompressed and in grey");
    }
    if (load_u32(&bytes[620]) != 0) {
      throw FormatError(path, 620, "compressed sequences are not read", "export it uncompressed");
    }
    if (stored != 8 && stored != 16) {
      throw FormatError(path, 556, "pixels of " + std::to_string(stored) + " bits are not read");
    }
    header_.packing = stored == 8 ? Packing::kU8 : Packing::kU16;
    header_.bits = static_cast<int>(real >= 1 && real <= stored ? real : stored);
    if (stored == 16 && header_.bits <= 8) header_.bits = 16;
    info_.width = static_cast<int>(width);
    info_.height = static_cast<int>(height);
    header_.image_bytes = width * height * (stored / 8);
    if (load_u32(&bytes[564]) != header_.image_bytes) {
      throw FormatError(path, 564,
                        "a picture has " + std::to_string(load_u32(&bytes[564])) +
                            " bytes where its size asks for " +
                            std::to_string(header_.image_bytes));
    }
    const bool renewed = load_i32(&bytes[28]) >= kNewVersion;
    header_.first_frame = renewed ? 8192 : 1024;
    header_.time_bytes = renewed ? 8 : 6;
    header_.frame_step = load_u32(&bytes[580]);
    if (header_.frame_step < header_.image_bytes) {
      throw FormatError(path, 580, "frames lie closer together than they are long");
    }
  }

  // What the header says, or what the file holds where the recording was not closed.
  std::int64_t frame_count(std::int64_t stated) {
    const std::int64_t room = file_.size() - header_.first_frame;
    const std::int64_t whole =
        room < header_.image_bytes ? 0 : (room - header_.image_bytes) / header_.frame_step + 1;
    if (whole == 0) throw FormatError(file_.path(), file_.size(), "the file holds no whole frame");
    if (stated > whole) {
      throw FormatError(
          file_.path(), file_.size(),
          "the file ends in frame " + std::to_string(whole) + " of " + std::to_string(stated));
    }
    if (stated == 0) {
      info_.warnings.push_back(
          "the header states no frames: the recording was not closed; those "
          "that the file holds are taken");
    }
    return stated > 0 ? stated : whole;
  }

  std::int64_t place(std::int64_t index) const {
    return header_.first_frame + index * header_.frame_step;
  }

  // Since 1970.
  std::int64_t time_us(std::int64_t index) const {
    const auto bytes = file_.bytes_at(place(index) + header_.image_bytes,
                                      static_cast<std::size_t>(header_.time_bytes));
    const std::int64_t fine = header_.time_bytes >= 8 ? load_u16(&bytes[6]) : 0;
    return load_u32(bytes.data()) * std::int64_t{1000000} + load_u16(&bytes[4]) * 1000 + fine;
  }

  // Times that do not grow are none. Those of old files are whole milliseconds.
  void look_at_times() {
    if (header_.frame_step < header_.image_bytes + header_.time_bytes ||
        !file_.holds(place(info_.frame_count - 1), header_.image_bytes + header_.time_bytes)) {
      return;
    }
    std::int64_t previous = time_us(0);
    for (std::int64_t k = 1; k < info_.frame_count; ++k) {
      const std::int64_t now = time_us(k);
      if (now <= previous) {
        info_.warnings.push_back("the time of frame " + std::to_string(k) +
                                 " does not grow: the times are not used");
        return;
      }
      previous = now;
    }
    info_.has_timestamps = info_.frame_count > 1;
  }

  ByteFile file_;
  SeqHeader header_;
  ClipInfo info_;
};

}  // namespace

std::unique_ptr<FrameSource> open_seq(const std::string& path, bool lend) {
  return std::make_unique<SeqSource>(path, lend);
}

}  // namespace impactdic::video
