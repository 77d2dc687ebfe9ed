// Phantom .cine: header, SETUP, time and exposure blocks, frame table, frames.
#include <impactdic/error.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "host/video/format/writers.h"

namespace impactdic::video {
namespace {

constexpr std::size_t kBitmapAt = 44, kSetupAt = 84, kSetupBytes = 13484;
constexpr std::int64_t kAnnotationBytes = 8;
constexpr double kTicksPerSecond = 4294967296.0;  // 2^32

void store_text(std::vector<std::uint8_t>& bytes, std::size_t at, const std::string& text) {
  std::copy(text.begin(),
            text.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(text.size(), 1023)),
            bytes.begin() + static_cast<std::ptrdiff_t>(at));
}

class CineSink : public FrameSink {
 public:
  CineSink(const std::string& path, Packing packing, const ClipInfo& info)
      : info_(info), packing_(packing) {
    check_depth();
    if (info.frame_count < 1 || info.frame_count > 0x7fffffff) {
      throw InvalidArgument("a cine needs the number of its frames before the first one", path);
    }
    frame_bytes_ = packed_bytes(packing, std::int64_t{info.width} * info.height);
    table_at_ = kSetupAt + kSetupBytes + block_bytes(8) + block_bytes(4);
    file_ = std::make_unique<OutputFile>(path);
    write_head();
    write_blocks();
    write_table();
  }

  void write(const Frame& frame) override {
    check_frame(frame, info_);
    if (written_ == info_.frame_count) {
      throw InvalidArgument("more frames than the cine was begun with", info_.path);
    }
    std::vector<std::uint8_t> annotation(kAnnotationBytes);
    store<std::uint32_t>(annotation, 0, static_cast<std::uint32_t>(kAnnotationBytes));
    store<std::uint32_t>(annotation, 4, static_cast<std::uint32_t>(frame_bytes_));
    file_->append(annotation);
    const bool bottom_up = packing_ == Packing::kU8 || packing_ == Packing::kU16;
    if (packing_ == Packing::kPacked10 && info_.bits == 12) {
      pack_frame(to_codes(frame), packing_, bottom_up, stored_);
    } else {
      pack_frame(frame, packing_, bottom_up, stored_);
    }
    file_->append(stored_);
    ++written_;
  }

  void finish() override {
    if (written_ != info_.frame_count) {
      throw InvalidArgument("the cine was begun with " + std::to_string(info_.frame_count) +
                                " frames and got " + std::to_string(written_),
                            info_.path);
    }
    file_->finish();
  }

 private:
  void check_depth() const {
    const bool fits = packing_ == Packing::kPacked10   ? info_.bits == 10 || info_.bits == 12
                      : packing_ == Packing::kPacked12 ? info_.bits == 12
                                                       : true;
    if (fits) return;
    throw InvalidArgument(
        std::to_string(info_.bits) + "-bit frames cannot be stored as " + packing_name(packing_),
        info_.path);
  }

  // Without a frame rate there are no times to write, and no block.
  std::int64_t block_bytes(std::int64_t per_frame) const {
    const bool there = per_frame == 8 ? info_.fps.has_value() : info_.exposure_s.has_value();
    return there ? 8 + per_frame * info_.frame_count : 0;
  }

  void write_head() {
    std::vector<std::uint8_t> head(kSetupAt + kSetupBytes);
    head[0] = 'C', head[1] = 'I';
    store<std::uint16_t>(head, 2, kBitmapAt);
    store<std::uint16_t>(head, 6, 1);
    const auto first = static_cast<std::int32_t>(info_.first_frame_number);
    const auto count = static_cast<std::uint32_t>(info_.frame_count);
    store<std::int32_t>(head, 8, first);
    store<std::uint32_t>(head, 12, count);
    store<std::int32_t>(head, 16, first);
    store<std::uint32_t>(head, 20, count);
    store<std::uint32_t>(head, 24, kBitmapAt);
    store<std::uint32_t>(head, 28, kSetupAt);
    store<std::uint32_t>(head, 32, static_cast<std::uint32_t>(table_at_));

    const bool deep = packing_ != Packing::kU8;
    const int bits = packing_ == Packing::kPacked10 ? 10 : info_.bits;
    store<std::uint32_t>(head, kBitmapAt, 40);
    store<std::int32_t>(head, kBitmapAt + 4, info_.width);
    store<std::int32_t>(head, kBitmapAt + 8, info_.height);
    store<std::uint16_t>(head, kBitmapAt + 12, 1);
    store<std::uint16_t>(head, kBitmapAt + 14, deep ? 16 : 8);
    store<std::uint32_t>(head, kBitmapAt + 16,
                         packing_ == Packing::kPacked10   ? 256
                         : packing_ == Packing::kPacked12 ? 1024
                                                          : 0);
    store<std::uint32_t>(head, kBitmapAt + 20, static_cast<std::uint32_t>(frame_bytes_));
    store<std::uint32_t>(head, kBitmapAt + 36, 1u << bits);
    write_setup(head, bits);
    file_->append(head);
  }

  void write_setup(std::vector<std::uint8_t>& head, int bits) const {
    const auto at = [](std::size_t offset) { return kSetupAt + offset; };
    head[at(140)] = 'S', head[at(141)] = 'T';
    store<std::uint16_t>(head, at(142), kSetupBytes);
    store<std::uint16_t>(head, at(737), static_cast<std::uint16_t>(info_.width));
    store<std::uint16_t>(head, at(739), static_cast<std::uint16_t>(info_.height));
    store<std::uint32_t>(head, at(896), static_cast<std::uint32_t>(bits));
    store<std::int32_t>(head, at(5736), (1 << bits) - 1);
    store<std::uint32_t>(head, at(12416), static_cast<std::uint32_t>(bits));
    store_text(head, at(12432), info_.camera);
    if (info_.fps) {
      const double whole = std::clamp(std::round(*info_.fps), 1.0, 4294967295.0);
      store<std::uint32_t>(head, at(768), static_cast<std::uint32_t>(whole));
      store<std::uint16_t>(head, at(0), static_cast<std::uint16_t>(std::min(whole, 65535.0)));
      store<std::uint64_t>(head, at(13472), std::bit_cast<std::uint64_t>(*info_.fps));
    }
    if (info_.exposure_s) {
      const double ns = std::clamp(std::round(*info_.exposure_s * 1e9), 0.0, 4294967295.0);
      store<std::uint32_t>(head, at(1568), static_cast<std::uint32_t>(ns));
      store<std::uint32_t>(head, at(772), static_cast<std::uint32_t>(ns / 1000));
    }
  }

  void write_blocks() {
    if (info_.fps) {
      std::vector<std::uint8_t> block(static_cast<std::size_t>(block_bytes(8)));
      store<std::uint32_t>(block, 0, static_cast<std::uint32_t>(block.size()));
      store<std::uint16_t>(block, 4, 1002);
      for (std::int64_t i = 0; i < info_.frame_count; ++i) {
        const double ticks = std::round(static_cast<double>(i) / *info_.fps * kTicksPerSecond / 4);
        store<std::uint64_t>(block, static_cast<std::size_t>(8 + 8 * i),
                             static_cast<std::uint64_t>(ticks) * 4);
      }
      file_->append(block);
    }
    if (info_.exposure_s) {
      std::vector<std::uint8_t> block(static_cast<std::size_t>(block_bytes(4)));
      store<std::uint32_t>(block, 0, static_cast<std::uint32_t>(block.size()));
      store<std::uint16_t>(block, 4, 1003);
      const double ticks = std::clamp(*info_.exposure_s * kTicksPerSecond, 0.0, 4294967295.0);
      for (std::int64_t i = 0; i < info_.frame_count; ++i) {
        store<std::uint32_t>(block, static_cast<std::size_t>(8 + 4 * i),
                             static_cast<std::uint32_t>(std::lround(ticks)));
      }
      file_->append(block);
    }
  }

  void write_table() {
    const std::int64_t first = table_at_ + 8 * info_.frame_count;
    std::vector<std::uint8_t> table(static_cast<std::size_t>(8 * info_.frame_count));
    for (std::int64_t i = 0; i < info_.frame_count; ++i) {
      store<std::int64_t>(table, static_cast<std::size_t>(8 * i),
                          first + i * (kAnnotationBytes + frame_bytes_));
    }
    file_->append(table);
  }

  // Linear 12-bit values to the camera's 10-bit codes.
  const Frame& to_codes(const Frame& frame) {
    if (codes_of_.empty()) {
      for (int v = 0; v < 4096; ++v) {
        codes_of_.push_back(phantom_code_10(static_cast<std::uint16_t>(v)));
      }
    }
    codes_.reset(info_.width, info_.height, 10);
    std::transform(frame.u16.data(), frame.u16.data() + frame.u16.size(), codes_.u16.data(),
                   [this](std::uint16_t v) { return codes_of_[std::min<std::size_t>(v, 4095)]; });
    return codes_;
  }

  ClipInfo info_;
  Packing packing_;
  std::int64_t frame_bytes_ = 0, table_at_ = 0, written_ = 0;
  std::unique_ptr<OutputFile> file_;
  std::vector<std::uint8_t> stored_;
  std::vector<std::uint16_t> codes_of_;
  Frame codes_;
};

}  // namespace

std::unique_ptr<FrameSink> open_cine_sink(const std::string& path, Packing packing,
                                          const ClipInfo& info) {
  return std::make_unique<CineSink>(path, packing, info);
}

}  // namespace impactdic::video
