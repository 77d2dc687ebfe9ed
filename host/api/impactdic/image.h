// Grey pictures in memory: `Image` owns, `ImageView` looks. Row-major, x right, y down, pixel
// centres at integers. Pitch is counted in elements, not bytes.
#pragma once

#include <impactdic/export.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace IMPACTDIC_PUBLIC impactdic {

template <typename T>
struct ImageView {
  T* data = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t pitch = 0;  // elements from one row to the next

  T* row(int y) const { return data + y * pitch; }
  T& operator()(int x, int y) const { return data[y * pitch + x]; }
  operator ImageView<const T>() const { return {data, width, height, pitch}; }
};

template <typename T>
class Image {
 public:
  Image() = default;
  Image(int width, int height, T fill = T())
      : width_(width), height_(height), pixels_(static_cast<std::size_t>(width) * height, fill) {}

  int width() const { return width_; }
  int height() const { return height_; }
  T* data() {
    take_over();
    return pixels_.data();
  }
  const T* data() const { return borrowed_ ? borrowed_.get() : pixels_.data(); }
  T* row(int y) { return data() + static_cast<std::size_t>(y) * width_; }
  const T* row(int y) const { return data() + static_cast<std::size_t>(y) * width_; }
  T& operator()(int x, int y) { return row(y)[x]; }
  const T& operator()(int x, int y) const { return row(y)[x]; }
  std::size_t size() const {
    return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  }
  ImageView<T> view() { return {data(), width_, height_, width_}; }
  ImageView<const T> view() const { return {data(), width_, height_, width_}; }

  // Changes the size; the pixels are then undefined. Keeps its memory where it suffices.
  void resize(int width, int height) {
    borrowed_.reset();
    width_ = width;
    height_ = height;
    pixels_.resize(static_cast<std::size_t>(width) * height);
  }

  // Shows pixels that lie elsewhere, row after row, and keeps them alive; they are copied when
  // someone wants to change them.
  void borrow(std::shared_ptr<const T[]> pixels, int width, int height) {
    borrowed_ = std::move(pixels);
    width_ = width;
    height_ = height;
  }

 private:
  void take_over() {
    if (!borrowed_) return;
    pixels_.assign(borrowed_.get(), borrowed_.get() + size());
    borrowed_.reset();
  }

  int width_ = 0, height_ = 0;
  std::vector<T> pixels_;
  std::shared_ptr<const T[]> borrowed_;
};

enum class PixelType : std::uint8_t { kU8, kU16 };

// One decoded grey frame at its native depth: 8-bit files stay 8-bit (they go to the device as
// they are), everything deeper is 16-bit with the value in the low bits. Only one of the two
// pictures is in use, the one `type` names.
struct Frame {
  PixelType type = PixelType::kU8;
  int bits = 8;  // effective bits: grey levels run 0 … 2^bits − 1
  Image<std::uint8_t> u8;
  Image<std::uint16_t> u16;

  int width() const { return type == PixelType::kU8 ? u8.width() : u16.width(); }
  int height() const { return type == PixelType::kU8 ? u8.height() : u16.height(); }
  double full_scale() const { return static_cast<double>((1u << bits) - 1); }
  const void* bytes() const {
    return type == PixelType::kU8 ? static_cast<const void*>(u8.data()) : u16.data();
  }
  std::size_t byte_count() const { return type == PixelType::kU8 ? u8.size() : 2 * u16.size(); }
  // Sets type, bits and size at once; pixels undefined.
  void reset(int width, int height, int effective_bits) {
    bits = effective_bits;
    type = effective_bits <= 8 ? PixelType::kU8 : PixelType::kU16;
    if (type == PixelType::kU8) {
      u8.resize(width, height);
      u16.resize(0, 0);
    } else {
      u16.resize(width, height);
      u8.resize(0, 0);
    }
  }
  // The same picture as floats in grey levels of the file; (height, width).
  Image<float> to_float() const {
    Image<float> out(width(), height());
    for (std::size_t i = 0; i < out.size(); ++i) {
      out.data()[i] = type == PixelType::kU8 ? static_cast<float>(u8.data()[i])
                                             : static_cast<float>(u16.data()[i]);
    }
    return out;
  }
};

}  // namespace impactdic
