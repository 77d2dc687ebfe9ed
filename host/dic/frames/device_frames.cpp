#include "host/dic/frames/device_frames.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "host/dic/frames/spline_frames.h"
#include "host/opencl/arguments.h"
#include "kernels/frames/unpack.h"

namespace impactdic::dic {
namespace {

// Rows first … first + count - 1 of all parts, one part behind the other.
void copy_rows(std::span<const FramePart> parts, std::size_t width, std::size_t height,
               std::size_t first, std::size_t count, unsigned char* to) {
  for (std::size_t row = first; row < first + count;) {
    const FramePart& part = parts[row / height];
    const Frame& frame = *part.frame;
    const std::size_t y = row % height, some = std::min(height - y, first + count - row);
    const std::size_t depth = frame.type == PixelType::kU8 ? 1 : 2;
    const std::size_t bytes = depth * width;
    const std::size_t pitch = depth * static_cast<std::size_t>(frame.width());
    const auto* from = static_cast<const unsigned char*>(frame.bytes()) +
                       (static_cast<std::size_t>(part.y) + y) * pitch +
                       static_cast<std::size_t>(part.x) * depth;
    row += some;
    if (bytes == pitch) {
      std::memcpy(to, from, bytes * some);
      to += bytes * some;
      continue;
    }
    for (std::size_t k = 0; k < some; ++k, from += pitch, to += bytes) std::memcpy(to, from, bytes);
  }
}

}  // namespace

DeviceFrames::DeviceFrames(opencl::Engine& engine, int slots)
    : engine_(engine),
      versions_(static_cast<std::size_t>(slots), 0),
      corners_(static_cast<std::size_t>(slots)),
      staging_(engine) {}

DeviceFrames::~DeviceFrames() = default;

opencl::ProgramRequest DeviceFrames::program(PixelType type) {
  return {"frames/unpack.cl", {{"PIXEL", type == PixelType::kU8 ? "uchar" : "ushort"}}};
}

std::uint64_t DeviceFrames::version(int slot) const {
  if (slot < 0 || slot >= slots()) {
    throw InvalidArgument("there is no frame slot " + std::to_string(slot));
  }
  return versions_[static_cast<std::size_t>(slot)];
}

void DeviceFrames::set(int slot, const Frame& frame) {
  const std::array<const Frame*, 1> one = {&frame};
  set(slot, one);
}

void DeviceFrames::check(const FramePart& part, int width, int height) {
  const Frame& frame = *part.frame;
  if (width < 1 || height < 1) throw InvalidArgument("the frame has no pixels");
  if (part.x < 0 || part.y < 0 || part.x + width > frame.width() ||
      part.y + height > frame.height()) {
    throw InvalidArgument("a part of a frame must lie in it");
  }
  if (images_.size() == 0) {
    width_ = width;
    height_ = height;
    pixel_type_ = frame.type;
    const std::size_t count = static_cast<std::size_t>(width_) * height_ * versions_.size();
    images_ = opencl::Buffer<float>(engine_, count);
    pixels_ = opencl::Buffer<unsigned char>(engine_, count * pixel_bytes() + kBytesBehind);
    unpack_ = engine_.kernel(program(frame.type), "unpack");
  }
  if (width != width_ || height != height_) {
    throw InvalidArgument("frames of one clip must have one size");
  }
  if (frame.type != pixel_type_) throw InvalidArgument("frames of one clip must have one depth");
}

void DeviceFrames::set(int first_slot, std::span<const Frame* const> frames) {
  if (frames.empty()) return;
  std::vector<FramePart> whole;
  for (const Frame* frame : frames) whole.push_back({frame});
  set(first_slot, whole, frames.front()->width(), frames.front()->height());
}

void DeviceFrames::set(int first_slot, std::span<const FramePart> parts, int width, int height) {
  if (parts.empty()) return;
  version(first_slot);
  version(first_slot + static_cast<int>(parts.size()) - 1);
  for (const FramePart& part : parts) check(part, width, height);
  full_scale_ = parts.back().frame->full_scale();
  const std::size_t pixels = static_cast<std::size_t>(width_) * height_;
  const std::size_t count = pixels * parts.size();
  const auto columns = static_cast<std::size_t>(width), lines = static_cast<std::size_t>(height);
  const cl::Buffer& uploaded =
      staging_.upload(lines * parts.size(), columns * pixel_bytes(),
                      [&](std::size_t first, std::size_t some, unsigned char* to) {
                        copy_rows(parts, columns, lines, first, some, to);
                      });
  opencl::set_arguments(unpack_, uploaded, images_.get(), pixels_.get(),
                        static_cast<cl_ulong>(count),
                        static_cast<cl_ulong>(pixels * static_cast<std::size_t>(first_slot)));
  engine_.launch(engine_.queue(), unpack_,
                 cl::NDRange(opencl::round_up((count + UNPACK_AT_ONCE - 1) / UNPACK_AT_ONCE, 64)),
                 cl::NDRange(64), {static_cast<double>((2 * pixel_bytes() + 4) * count), 0});
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::size_t slot = static_cast<std::size_t>(first_slot) + i;
    ++versions_[slot];
    corners_[slot] = {parts[i].frame_at.x + parts[i].x, parts[i].frame_at.y + parts[i].y};
  }
}

const SplineFrames& DeviceFrames::splines(int degree, double presmooth_sigma_px,
                                          std::optional<Tiling> tiling) {
  const int vector = choose_tiling(engine_, tiling, 1).vector;
  auto found = std::find_if(splines_.begin(), splines_.end(), [&](const auto& splines) {
    return splines->degree() == degree && splines->presmooth_sigma_px() == presmooth_sigma_px &&
           splines->vector() == vector;
  });
  if (found == splines_.end()) {
    splines_.push_back(
        std::make_unique<SplineFrames>(engine_, degree, presmooth_sigma_px, slots(), tiling));
    found = splines_.end() - 1;
  }
  (*found)->prepare(*this);
  return **found;
}

}  // namespace impactdic::dic
