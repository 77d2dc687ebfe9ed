#include "host/dic/device_frames.h"

namespace impactdic {

void DeviceFrames::set(int slot, const Frame& frame) {
  if (slot < 0 || slot >= slots_) throw InvalidArgument("no such frame slot");
  const std::size_t count = static_cast<std::size_t>(frame.width()) * frame.height();
  if (images_.size() == 0) {
    width_ = frame.width();
    height_ = frame.height();
    images_ = Buffer<float>(engine_, count * static_cast<std::size_t>(slots_));
  }
  if (frame.width() != width_ || frame.height() != height_) {
    throw InvalidArgument("frames of one clip must have one size");
  }
  if (unpack_() == nullptr || unpack_type_ != frame.type) {
    unpack_type_ = frame.type;
    unpack_ = engine_.kernel("unpack.cl", "unpack",
                             {{"PIXEL", frame.type == PixelType::u8 ? "uchar" : "ushort"}});
  }
  full_scale_ = frame.full_scale();
  staging_.reserve(engine_, frame.byte_count());
  staging_.write(engine_, {static_cast<const unsigned char*>(frame.bytes()), frame.byte_count()});
  unpack_.setArg(0, staging_.get());
  unpack_.setArg(1, images_.get());
  unpack_.setArg(2, static_cast<cl_ulong>(count));
  unpack_.setArg(3, static_cast<cl_ulong>(count * static_cast<std::size_t>(slot)));
  engine_.launch(engine_.queue(), unpack_, cl::NDRange(round_up(count, 64)), cl::NDRange(64),
                 {static_cast<double>(frame.byte_count() + 4 * count), 0});
}

}  // namespace impactdic
