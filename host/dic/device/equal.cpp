#include "host/dic/device/equal.h"

#include <algorithm>
#include <cmath>

#include "host/dic/reference/zncc.h"
#include "host/opencl/arguments.h"

namespace impactdic::dic {

std::size_t EqualVariant::local_bytes(int window_px) const {
  const auto side = static_cast<std::size_t>(window_px);
  if (as_bytes) return sizeof(cl_int) * ((side + 8) * 12 + 53 * side + 8);
  const std::size_t plane = 2 * side * (side + static_cast<std::size_t>(vector));
  const std::size_t scratch = window_px == lanes * vector && vector == 1 ? 8 * side : plane;
  return sizeof(cl_float) * (plane + scratch + 4 * side + 6);
}

std::string EqualVariant::name() const {
  return (as_bytes ? "bytes vector " : "vector ") + std::to_string(vector) + " lanes " +
         std::to_string(lanes) + (chain > 1 ? " chain " + std::to_string(chain) : "") +
         (width_known ? " width" : "") + (warp_barrier ? " warp" : "") +
         (matrix_units ? " matrix" : "") +
         (most_registers > 0 ? " registers " + std::to_string(most_registers) : "");
}

std::vector<EqualVariant> equal_variants(const opencl::Device& device, int window_px) {
  std::vector<EqualVariant> variants;
  const auto offer = [&](const EqualVariant& variant) {
    if (variant.vector <= window_px / 2 &&
        variant.local_bytes(window_px) <= device.local_memory_bytes &&
        static_cast<std::size_t>(variant.lanes) <= device.max_work_group) {
      variants.push_back(variant);
    }
  };
  if (!device.is_gpu) {
    for (const int vector : {8, 16, 4}) offer({vector, 1, 1, false, false, 0});
    offer({1, window_px, 2, true, false, 0});
    return variants;
  }
  const bool is_nvidia = device.vendor.find("NVIDIA") != std::string::npos;
  const bool is_warp = is_nvidia && window_px == 32;
  for (const int chain : {8, 16, 4, 1}) offer({1, window_px, chain, true, is_warp, 0});
  for (const int registers : {168, 144, 128}) {
    if (is_nvidia) offer({1, window_px, 8, true, is_warp, registers});
  }
  if (is_warp) offer({1, window_px, 8, true, false, 0});
  offer({1, window_px, 8, false, is_warp, 0});
  if (device.multiplies_bytes && window_px == 32) {
    for (const int registers : {0, 80}) {
      offer({1, 32, 1, true, true, registers, true, true});
    }
  }
  offer({4, 1, 1, false, false, 0});
  return variants;
}

EqualOpencl::EqualOpencl(opencl::Engine& engine, const FieldOptions& options,
                         const EqualVariant& variant)
    : engine_(engine), options_(options), variant_(variant) {
  if (options.window_px != 16 && options.window_px != 32) {
    throw InvalidArgument("equal windows are 16 or 32 px wide", "--window");
  }
}

EqualVariant EqualOpencl::variant_for(PixelType type) const {
  if (!variant_.as_bytes || type == PixelType::kU8) return variant_;
  const auto variants = equal_variants(engine_.device(), options_.window_px);
  return *std::find_if(variants.begin(), variants.end(),
                       [](const EqualVariant& variant) { return !variant.as_bytes; });
}

void EqualOpencl::compile(const StoredPictures& pictures) {
  const EqualVariant variant = variant_for(pictures.type);
  opencl::Defines defines = {{"FFT_PX", std::to_string(options_.window_px)},
                             {"VECTOR", std::to_string(variant.vector)},
                             {"LANES", std::to_string(variant.lanes)},
                             {"PIXEL", pictures.type == PixelType::kU8 ? "uchar" : "ushort"}};
  if (variant.chain > 1) defines.emplace_back("CHAIN", std::to_string(variant.chain));
  if (variant.warp_barrier) defines.emplace_back("WARP_BARRIER", "1");
  if (variant.matrix_units) defines.emplace_back("MATRIX_UNITS", "1");
  if (variant.most_registers > 0) defines.emplace_back("FREE_GROUP_SIZE", "1");
  if (variant.width_known) defines.emplace_back("WIDTH", std::to_string(pictures.width));
  if (correlate_() != nullptr && defines == defines_) return;
  const std::string options = variant.most_registers > 0
                                  ? "-cl-nv-maxrregcount=" + std::to_string(variant.most_registers)
                                  : "";
  correlate_ = engine_.kernel(variant.as_bytes ? "equal/equal_bytes.cl" : "equal/equal.cl",
                              variant.as_bytes ? "equal_bytes" : "equal_windows", defines, options);
  finish_ = engine_.kernel("equal/equal_motions.cl", "equal_motions",
                           {{"FFT_PX", std::to_string(options_.window_px)}});
  defines_ = defines;
}

void EqualOpencl::run(const DeviceFrames& frames, const opencl::Buffer<Window>& windows,
                      std::size_t count, opencl::Buffer<WindowMotion>& motions,
                      std::size_t period) {
  run(StoredPictures{frames.pixels().get(), frames.width(), frames.height(), frames.pixel_type(),
                     frames.full_scale()},
      windows, count, motions, period);
}

void EqualOpencl::run(const StoredPictures& pictures, const opencl::Buffer<Window>& windows,
                      std::size_t count, opencl::Buffer<WindowMotion>& motions,
                      std::size_t period) {
  if (count > windows.size() || count > motions.size()) {
    throw InvalidArgument("more windows than their buffers hold");
  }
  if (pictures.width < options_.window_px || pictures.height < options_.window_px) {
    throw InvalidArgument("the pictures are smaller than a window", "--window");
  }
  if (count == 0) return;
  if (period == 0) period = count;
  compile(pictures);
  peaks_.reserve(engine_, count);
  const double side = options_.window_px, points = side * side;
  const auto done = static_cast<double>(count);
  const double pixel_bytes = pictures.type == PixelType::kU8 ? 1 : 2;
  const EqualVariant variant = variant_for(pictures.type);
  std::size_t groups = count;
  if (variant.as_bytes) {
    opencl::set_arguments(correlate_, pictures.pixels, pictures.width, pictures.height,
                          windows.get(), peaks_.get());
  } else {
    opencl::set_arguments(correlate_, pictures.pixels, pictures.width, pictures.height,
                          windows.get(), static_cast<cl_uint>(count), static_cast<cl_uint>(period),
                          peaks_.get());
    const auto followed = static_cast<std::size_t>(variant.chain) * period;
    groups = (count + followed - 1) / followed * ((period + 1) / 2);
  }
  const auto lanes = static_cast<std::size_t>(variant.lanes);
  engine_.launch(engine_.queue(), correlate_, cl::NDRange(groups * lanes), cl::NDRange(lanes),
                 {done * (2 * points * pixel_bytes + sizeof(Window) + sizeof(EqualPeak)),
                  done * equal_flops(options_.window_px)});
  opencl::set_arguments(finish_, windows.get(), peaks_.get(), pictures.width, pictures.height,
                        static_cast<cl_uint>(count),
                        static_cast<float>(min_contrast(options_, pictures.full_scale)),
                        static_cast<float>(options_.min_correlation), motions.get());
  engine_.launch(engine_.queue(), finish_, cl::NDRange(opencl::round_up(count, 32)),
                 cl::NDRange(32),
                 {done * (sizeof(Window) + sizeof(EqualPeak) + sizeof(WindowMotion)), 0});
}

double equal_flops(int window_px) {
  const double points = static_cast<double>(window_px) * window_px;
  // Three complex transforms of two windows, 5 N log2 N each, and their products.
  return 1.5 * 5 * points * std::log2(points) + 6 * points;
}

}  // namespace impactdic::dic
