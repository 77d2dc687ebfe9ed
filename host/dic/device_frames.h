// Frames on the device as floats, in numbered slots.
#pragma once

#include "host/base/image.h"
#include "host/opencl/buffer.h"

namespace impactdic {

class DeviceFrames {
 public:
  DeviceFrames(Engine& engine, int slots) : engine_(engine), slots_(slots) {}

  // Copies the frame at its stored depth and unpacks it on the device. The first frame sets the
  // size; throws InvalidArgument for another one or a slot that is not there.
  void set(int slot, const Frame& frame);

  int slots() const { return slots_; }
  int width() const { return width_; }
  int height() const { return height_; }
  // (slots, height, width) floats in grey levels of the file; slot s begins at s·height·width.
  const Buffer<float>& images() const { return images_; }
  // Grey level of white (255 for 8 bit), of the last frame set.
  double full_scale() const { return full_scale_; }

 private:
  Engine& engine_;
  int slots_ = 0, width_ = 0, height_ = 0;
  double full_scale_ = 255;
  Buffer<float> images_;
  Buffer<unsigned char> staging_;
  cl::Kernel unpack_;
  PixelType unpack_type_ = PixelType::u8;
};

}  // namespace impactdic
