// Frames on the device, as stored and as floats, in numbered slots, and what is worked out from
// them: one copy for all that measure on them.
#pragma once

#include <impactdic/image.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "host/dic/device/tiling.h"
#include "host/opencl/buffer.h"
#include "host/opencl/staging.h"

namespace impactdic::dic {

class SplineFrames;

// Bytes behind stored pictures on the device: kernels may read more of a row than they use.
inline constexpr std::size_t kBytesBehind = 64;

// Pixel (0, 0) of a part, in the picture that it is a part of.
struct PartCorner {
  int x = 0, y = 0;
};

// A rectangle of a frame: its corner at the top left.
struct FramePart {
  const Frame* frame = nullptr;
  int x = 0, y = 0;
  PartCorner frame_at = {};  // pixel (0, 0) of the frame, where it is a part of a picture itself
};

class DeviceFrames {
 public:
  // `engine` must outlive the object.
  DeviceFrames(opencl::Engine& engine, int slots);
  // What unpacks pictures of this depth.
  static opencl::ProgramRequest program(PixelType type);
  ~DeviceFrames();

  // Copies the frame at its stored depth and unpacks it on the device. The first frame sets size
  // and depth; throws InvalidArgument for another size or depth, or a slot that is not there.
  void set(int slot, const Frame& frame);
  // The same for several frames into the slots from `first_slot` on, all in one copy. Returns
  // when the frames may change; kernels enqueued later see the new pictures.
  void set(int first_slot, std::span<const Frame* const> frames);
  // The same for rectangles of `width` × `height`, which are then all that the slots know: pixel
  // (0, 0) is a part's corner. Throws InvalidArgument where a part leaves its frame.
  void set(int first_slot, std::span<const FramePart> parts, int width, int height);

  int slots() const { return static_cast<int>(versions_.size()); }
  int width() const { return width_; }
  int height() const { return height_; }
  // Counts the pictures that came into `slot`; 0: it holds none. Throws InvalidArgument for a slot
  // that is not there.
  std::uint64_t version(int slot) const;
  // Of what the slots hold, one a slot.
  const std::vector<PartCorner>& corners() const { return corners_; }
  // (slots, height, width) floats in grey levels of the file; slot s begins at s·height·width.
  const opencl::Buffer<float>& images() const { return images_; }
  // The same at their stored depth.
  const opencl::Buffer<unsigned char>& pixels() const { return pixels_; }
  PixelType pixel_type() const { return pixel_type_; }
  int pixel_bytes() const { return pixel_type_ == PixelType::kU8 ? 1 : 2; }
  // The B-splines of all slots that hold a picture, up to date (enqueued); worked out once for
  // everyone who asks for the same.
  const SplineFrames& splines(int degree, double presmooth_sigma_px,
                              std::optional<Tiling> tiling = {});
  // Grey level of white (255 for 8 bit), of the last frame set.
  double full_scale() const { return full_scale_; }

 private:
  void check(const FramePart& part, int width, int height);

  opencl::Engine& engine_;
  int width_ = 0, height_ = 0;
  double full_scale_ = 255;
  std::vector<std::uint64_t> versions_;
  std::vector<PartCorner> corners_;
  opencl::Buffer<float> images_;
  opencl::Buffer<unsigned char> pixels_;
  opencl::Staging staging_;
  cl::Kernel unpack_;
  PixelType pixel_type_ = PixelType::kU8;
  std::vector<std::unique_ptr<SplineFrames>> splines_;
};

}  // namespace impactdic::dic
