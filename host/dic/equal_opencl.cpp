#include "host/dic/equal_opencl.h"

#include <cmath>

#include "host/dic/zncc_reference.h"
#include "host/opencl/arguments.h"

namespace impactdic {

std::size_t EqualVariant::local_bytes(int window_px) const {
  const auto side = static_cast<std::size_t>(window_px);
  const std::size_t planes = window_px == lanes * vector ? 1 : 2;
  return sizeof(cl_float) * (planes * 2 * side * (side + vector) + 2 * side +
                             static_cast<std::size_t>(pairs) * (2 * side + 14));
}

std::string EqualVariant::name() const {
  return "vector " + std::to_string(vector) + " lanes " + std::to_string(lanes) + " pairs " +
         std::to_string(pairs) + (width_known ? " width" : "") +
         (most_registers > 0 ? " registers " + std::to_string(most_registers) : "");
}

std::vector<EqualVariant> equal_variants(const DeviceInfo& device, int window_px) {
  std::vector<EqualVariant> variants;
  const auto offer = [&](const EqualVariant& variant) {
    if (variant.vector <= window_px / 2 &&
        variant.local_bytes(window_px) <= device.local_memory_bytes &&
        static_cast<std::size_t>(variant.lanes) <= device.max_work_group) {
      variants.push_back(variant);
    }
  };
  if (!device.is_gpu) {
    for (const int vector : {8, 16, 4}) offer({vector, 1, 1, false, 0});
    offer({1, window_px, 2, true, 0});
    return variants;
  }
  const bool limits_registers = device.vendor.find("NVIDIA") != std::string::npos;
  for (const bool width_known : {true, false}) {
    for (const int pairs : {2, 1, 4, 16}) offer({1, window_px, pairs, width_known, 0});
  }
  for (const int registers : {160, 128}) {
    if (limits_registers) offer({1, window_px, 1, true, registers});
  }
  offer({4, 1, 1, false, 0});
  return variants;
}

EqualOpencl::EqualOpencl(Engine& engine, const FieldOptions& options, const EqualVariant& variant)
    : engine_(engine), options_(options), variant_(variant) {
  if (options.window_px != 16 && options.window_px != 32) {
    throw InvalidArgument("equal windows are 16 or 32 px wide", "--window");
  }
}

void EqualOpencl::compile(const DeviceFrames& frames) {
  Defines defines = {{"FFT_PX", std::to_string(options_.window_px)},
                     {"VECTOR", std::to_string(variant_.vector)},
                     {"LANES", std::to_string(variant_.lanes)},
                     {"PIXEL", frames.pixel_type() == PixelType::u8 ? "uchar" : "ushort"}};
  defines.emplace_back("PAIRS", std::to_string(variant_.pairs));
  if (variant_.most_registers > 0) defines.emplace_back("FREE_GROUP_SIZE", "1");
  if (variant_.width_known) defines.emplace_back("WIDTH", std::to_string(frames.width()));
  if (kernel_() != nullptr && defines == defines_) return;
  const std::string options = variant_.most_registers > 0
                                  ? "-cl-nv-maxrregcount=" + std::to_string(variant_.most_registers)
                                  : "";
  kernel_ = engine_.kernel("equal.cl", "equal_windows", defines, options);
  defines_ = defines;
}

void EqualOpencl::run(const DeviceFrames& frames, const Buffer<Window>& windows, std::size_t count,
                      Buffer<WindowMotion>& motions) {
  if (count > windows.size() || count > motions.size()) {
    throw InvalidArgument("more windows than their buffers hold");
  }
  if (frames.width() < options_.window_px || frames.height() < options_.window_px) {
    throw InvalidArgument("the pictures are smaller than a window", "--window");
  }
  if (count == 0) return;
  compile(frames);
  set_arguments(kernel_, frames.pixels().get(), frames.width(), frames.height(), windows.get(),
                static_cast<cl_uint>(count),
                static_cast<float>(min_contrast(options_, frames.full_scale())),
                static_cast<float>(options_.min_correlation), motions.get());
  const auto lanes = static_cast<std::size_t>(variant_.lanes);
  const auto windows_a_group = 2 * static_cast<std::size_t>(variant_.pairs);
  const double side = options_.window_px, points = side * side;
  const auto done = static_cast<double>(count);
  engine_.launch(
      engine_.queue(), kernel_,
      cl::NDRange(round_up(count, windows_a_group) / windows_a_group * lanes), cl::NDRange(lanes),
      {done * (2 * points * frames.pixel_bytes() + sizeof(Window) + sizeof(WindowMotion)),
       done * equal_flops(options_.window_px)});
}

double equal_flops(int window_px) {
  const double points = static_cast<double>(window_px) * window_px;
  // Three complex transforms of two windows, 5 N log2 N each, and their products.
  return 1.5 * 5 * points * std::log2(points) + 6 * points;
}

}  // namespace impactdic
