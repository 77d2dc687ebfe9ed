#include "host/dic/device/zncc.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "host/dic/device/map_spline.h"
#include "host/dic/reference/zncc.h"
#include "host/opencl/arguments.h"

namespace impactdic::dic {
namespace {

// Device memory that the scratch of one batch may take.
constexpr std::size_t kBatchBytes = std::size_t{256} << 20;
// Windows whose peaks are kept at a time.
constexpr std::size_t kMostPeaks = std::size_t{1} << 18;

int area_px(const FieldOptions& options) { return options.window_px + 2 * options.search_px; }
int lags(const FieldOptions& options) { return 2 * options.search_px + 1; }

bool fits(const ZnccVariant& variant, const FieldOptions& options, const opencl::Device& device) {
  if (variant.path == ZnccPath::kBytes && (options.window_px > 31 || lags(options) > 33))
    return false;
  return area_px(options) <= variant.fft_px &&
         (variant.path == ZnccPath::kBytes ||
          variant.fft_px % (variant.vector * variant.lanes) == 0) &&
         (variant.path != ZnccPath::kPairs || variant.vector <= variant.fft_px / 2) &&
         static_cast<std::size_t>(variant.lanes) <= device.max_work_group &&
         variant.local_bytes(options) <= device.local_memory_bytes;
}

opencl::Defines defines_of(const FieldOptions& options, const ZnccVariant& variant) {
  return {{"WINDOW_PX", std::to_string(options.window_px)},
          {"SEARCH_PX", std::to_string(options.search_px)},
          {"FFT_PX", std::to_string(variant.fft_px)}};
}

// The weights that CorrelationPeak (kernels/types.h) speaks of, out of quintic_inverse(n).
std::vector<cl_float> peak_weights() {
  constexpr int kSide = PEAK_PATCH_PX, kReach = PEAK_NEAR / 2;
  std::vector<cl_float> all(static_cast<std::size_t>(kSide + 1) * kSide * kSide * PEAK_WEIGHTS,
                            0.0F);
  for (int n = 3; n <= kSide; ++n) {
    const std::vector<double> inverse = quintic_inverse(n);
    for (int place = 0; place < n; ++place) {
      for (int k = 0; k < n; ++k) {
        const std::size_t first =
            (static_cast<std::size_t>(n * kSide + place) * kSide + static_cast<std::size_t>(k)) *
            PEAK_WEIGHTS;
        for (int i = 0; i < PEAK_NEAR; ++i) {
          const int coefficient = mirrored_index(place + i - kReach, n);
          all[first + static_cast<std::size_t>(i)] = static_cast<cl_float>(
              inverse[static_cast<std::size_t>(coefficient) * static_cast<std::size_t>(n) +
                      static_cast<std::size_t>(k)]);
        }
      }
    }
  }
  return all;
}

std::unique_ptr<ZnccOpencl> make_for_deep_pixels(opencl::Engine& engine,
                                                 const FieldOptions& options) {
  const auto variants = zncc_variants(engine.device(), options);
  const auto found = std::find_if(variants.begin(), variants.end(), [](const ZnccVariant& variant) {
    return variant.path != ZnccPath::kBytes;
  });
  return std::make_unique<ZnccOpencl>(engine, options, *found);
}

// Nothing here is as small as a denormal number, but square roots and quotients provide for it.
std::string device_options(const opencl::Engine& engine) {
  return engine.device().is_gpu ? "-cl-denorms-are-zero" : "";
}

opencl::ProgramRequest subpixel_program(const opencl::Engine& engine) {
  return {"zncc/peak.cl", {}, device_options(engine)};
}

std::string name_of(ZnccPath path) {
  switch (path) {
    case ZnccPath::kBytes:
      return "bytes";
    case ZnccPath::kPairs:
      return "pairs";
    case ZnccPath::kSingle:
      return "single";
    case ZnccPath::kClfft:
      break;
  }
  return "clfft";
}

}  // namespace

double zncc_flops(const ZnccVariant& variant) {
  const double points = static_cast<double>(variant.fft_px) * variant.fft_px;
  const double transforms = variant.path == ZnccPath::kPairs ? 1.5 : 2;
  return transforms * 5 * points * std::log2(points);
}

std::size_t ZnccVariant::local_bytes(const FieldOptions& options) const {
  const auto side = static_cast<std::size_t>(lags(options));
  const auto size = static_cast<std::size_t>(fft_px), pitch = size + vector;
  if (path == ZnccPath::kBytes) {
    const auto window = static_cast<std::size_t>(options.window_px), area = window + side - 1;
    const std::size_t area_pitch = 8 * ((area + 31) / 32) + 4, blocks = (window + 7) / 8;
    const std::size_t area_rows = 8 * ((blocks + (side + 7) / 8) / 2 * 2 + 1);
    const std::size_t pixels = area_rows * area_pitch + 8 * blocks * (4 * ((window + 15) / 16) + 8);
    return sizeof(cl_float) *
           (std::max(pixels, side * (area | 1)) + std::max(side * side, window * window) + 16);
  }
  const std::size_t planes = fft_px == lanes * vector ? 1 : 2;
  constexpr std::size_t kLines = std::size_t{PEAK_PATCH_PX} * PEAK_WEIGHTS;
  const auto items = static_cast<std::size_t>(lanes);
  if (path == ZnccPath::kPairs && vector == 1) {
    const std::size_t plane = std::max(2 * size * pitch, 4 * side * pitch);
    return sizeof(cl_float) *
           (plane + std::max(8 * size, 2 * kLines) + 2 * side * side + 4 * size + 8);
  }
  if (path == ZnccPath::kPairs) {
    const std::size_t rows = std::max(size, 2 * side);
    return sizeof(cl_float) *
           (planes * 2 * rows * pitch + 2 * side * side + 4 * size + 4 * items + 4 + 2 * kLines);
  }
  const std::size_t plane = planes * 2 * size * pitch;
  if (vector == 1) {
    const std::size_t later = 2 * side * (size / 2 + 1 + pitch);
    return sizeof(cl_float) * (std::max(plane, later) + std::max(side * side, 2 * size) + side + 4);
  }
  return sizeof(cl_float) * (plane + side * side + 2 * items + kLines);
}

std::string ZnccVariant::name() const {
  const std::string size = " " + std::to_string(fft_px);
  if (path == ZnccPath::kClfft) return name_of(path) + size;
  const std::string shape =
      size + " vector " + std::to_string(vector) + " lanes " + std::to_string(lanes);
  return name_of(path) + shape + (width_known ? " width" : "") + (warp_barrier ? " warp" : "") +
         (matrix_units ? " matrix" : "") +
         (most_registers > 0 ? " registers " + std::to_string(most_registers) : "");
}

std::vector<ZnccVariant> zncc_variants(const opencl::Device& device, const FieldOptions& options) {
  std::vector<ZnccVariant> variants;
  const auto offer = [&](const ZnccVariant& variant) {
    if (fits(variant, options, device)) variants.push_back(variant);
  };
  const bool is_nvidia = device.vendor.find("NVIDIA") != std::string::npos;
  const auto offer_bytes = [&](int size) {
    for (const int registers : {128, 0}) {
      if (device.multiplies_bytes) {
        offer({ZnccPath::kBytes, size, 1, 32, true, true, registers, true});
      }
    }
  };
  for (const int size : {16, 32, 64}) {
    if (size < area_px(options) || !variants.empty()) continue;
    if (!device.is_gpu) {
      for (const int vector : {8, 16, 4}) {
        if (size <= 32) offer({ZnccPath::kPairs, size, vector, 1});
      }
      for (const int vector : {8, 16}) offer({ZnccPath::kSingle, size, vector, 1});
      continue;
    }
    // Small windows are as much work behind the products as behind transforms.
    if (size == 64) offer_bytes(size);
    const ZnccPath path = size <= 32 ? ZnccPath::kPairs : ZnccPath::kSingle;
    const bool is_warp = is_nvidia && size == 32;
    for (const int registers : {168, 144, 128}) {
      if (is_nvidia) offer({path, size, 1, size, true, is_warp, registers});
    }
    offer({path, size, 1, size, true, is_warp, 0});
    if (is_warp) offer({path, size, 1, size, true, false, 0});
    offer({path, size, 1, size, false, is_warp, 0});
    if (size <= 32) offer({ZnccPath::kSingle, size, 1, size, true, is_warp, 0});
    if (size <= 32) offer_bytes(size);
  }
  const auto length = opencl::FftPlan::good_size(static_cast<std::size_t>(area_px(options)));
  variants.push_back({ZnccPath::kClfft, static_cast<int>(length), 1, 1});
  return variants;
}

ZnccOpencl::ZnccOpencl(opencl::Engine& engine, const FieldOptions& options,
                       const ZnccVariant& variant)
    : engine_(engine), options_(options), variant_(variant) {
  opencl::Defines defines = defines_of(options, variant);
  weights_ = opencl::make_buffer<cl_float>(engine, peak_weights());
  subpixel_ = engine.kernel(subpixel_program(engine), "zncc_subpixel");
  if (variant.path != ZnccPath::kClfft) return;
  group_ =
      engine.device().is_gpu ? std::min<std::size_t>(group_, engine.device().max_work_group) : 1;
  defines.emplace_back("GROUP", std::to_string(group_));
  cut_ = engine.kernel("zncc/window.cl", "cut_windows", defines);
  power_ = engine.kernel("zncc/spectrum.cl", "cross_power", defines);
  map_ = engine.kernel("zncc/map.cl", "zncc_map", defines);
}

void ZnccOpencl::reserve_batch(std::size_t count) {
  const auto side = static_cast<std::size_t>(variant_.fft_px);
  const auto rows = static_cast<std::size_t>(lags(options_));
  const std::size_t plane = side * side, sums = rows * static_cast<std::size_t>(area_px(options_));
  const std::size_t bytes = (plane + sums + 1) * sizeof(cl_float2) + rows * rows * sizeof(cl_float);
  const std::size_t most = std::clamp<std::size_t>(kBatchBytes / bytes, 1, 1024);
  const std::size_t wanted = std::min(std::bit_ceil(count), most);
  if (wanted <= batch_) return;
  batch_ = wanted;
  plan_.emplace(engine_, side, side, batch_);
  planes_ = opencl::Buffer<cl_float2>(engine_, batch_ * plane);
  sums_ = opencl::Buffer<cl_float2>(engine_, batch_ * sums);
  levels_ = opencl::Buffer<cl_float2>(engine_, batch_);
  maps_ = opencl::Buffer<cl_float>(engine_, batch_ * rows * rows);
}

float ZnccOpencl::contrast(const DeviceFrames& frames) const {
  return static_cast<float>(min_contrast(options_, frames.full_scale()));
}

std::vector<opencl::ProgramRequest> ZnccOpencl::programs(const opencl::Engine& engine,
                                                         const FieldOptions& options,
                                                         const ZnccVariant& variant, PixelType type,
                                                         int width) {
  if (variant.path == ZnccPath::kClfft) return {subpixel_program(engine)};
  opencl::ProgramRequest fused;
  fused.file = "zncc/" + name_of(variant.path) + (variant.vector > 1 ? "_vector.cl" : ".cl");
  fused.defines = defines_of(options, variant);
  fused.options = device_options(engine);
  opencl::Defines& defines = fused.defines;
  defines.emplace_back("PIXEL", type == PixelType::kU8 ? "uchar" : "ushort");
  defines.emplace_back("VECTOR", std::to_string(variant.vector));
  defines.emplace_back("LANES", std::to_string(variant.lanes));
  if (variant.width_known) defines.emplace_back("WIDTH", std::to_string(width));
  if (variant.warp_barrier) defines.emplace_back("WARP_BARRIER", "1");
  if (variant.matrix_units) defines.emplace_back("MATRIX_UNITS", "1");
  if (variant.most_registers > 0) {
    defines.emplace_back("FREE_GROUP_SIZE", "1");
    fused.options += " -cl-nv-maxrregcount=" + std::to_string(variant.most_registers);
  }
  return {fused, subpixel_program(engine)};
}

void ZnccOpencl::compile_fused(const DeviceFrames& frames) {
  const opencl::ProgramRequest request =
      programs(engine_, options_, variant_, frames.pixel_type(), frames.width()).front();
  if (fused_() != nullptr && request.defines == fused_defines_) return;
  fused_ = engine_.kernel(request, "zncc_" + name_of(variant_.path));
  fused_defines_ = request.defines;
}

void ZnccOpencl::enqueue_fused(const DeviceFrames& frames, const opencl::Buffer<Window>& windows,
                               std::size_t start, std::size_t count) {
  const bool pairs = variant_.path == ZnccPath::kPairs;
  compile_fused(frames);
  const auto group = static_cast<std::size_t>(variant_.lanes);
  const std::size_t groups = pairs ? (count + 1) / 2 : count;
  const bool as_stored = pairs || variant_.vector == 1;
  int argument = 0;
  opencl::set_argument(fused_, argument++,
                       as_stored ? frames.pixels().get() : frames.images().get());
  opencl::set_argument(fused_, argument++, static_cast<cl_int>(frames.width()));
  opencl::set_argument(fused_, argument++, static_cast<cl_int>(frames.height()));
  opencl::set_argument(fused_, argument++, windows.get());
  opencl::set_argument(fused_, argument++, static_cast<cl_uint>(start));
  if (pairs) opencl::set_argument(fused_, argument++, static_cast<cl_uint>(count));
  opencl::set_argument(fused_, argument++, contrast(frames));
  opencl::set_argument(fused_, argument++, weights_.get());
  opencl::set_argument(fused_, argument++, peaks_.get());
  const double area = area_px(options_), window = options_.window_px;
  const auto windows_done = static_cast<double>(count);
  engine_.launch(engine_.queue(), fused_, cl::NDRange(groups * group), cl::NDRange(group),
                 {windows_done * (4 * (area * area + window * window) + sizeof(CorrelationPeak)),
                  windows_done * zncc_flops(variant_)});
}

void ZnccOpencl::enqueue_batch(const DeviceFrames& frames, const opencl::Buffer<Window>& windows,
                               std::size_t start, std::size_t at, std::size_t count) {
  const cl::CommandQueue& queue = engine_.queue();
  const auto side = static_cast<std::size_t>(variant_.fft_px);
  const auto begin = static_cast<cl_uint>(start + at);
  const cl::NDRange range(count * group_), group(group_);
  const double planes = static_cast<double>(count) * 8.0 * static_cast<double>(side * side);
  int argument = 0;
  for (cl::Kernel* kernel : {&cut_, &map_}) {
    argument = 0;
    opencl::set_argument(*kernel, argument++, frames.images().get());
    opencl::set_argument(*kernel, argument++, static_cast<cl_int>(frames.width()));
    opencl::set_argument(*kernel, argument++, static_cast<cl_int>(frames.height()));
    opencl::set_argument(*kernel, argument++, windows.get());
    opencl::set_argument(*kernel, argument++, begin);
  }
  opencl::set_argument(cut_, argument, planes_.get());
  opencl::set_argument(cut_, argument + 1, levels_.get());
  engine_.launch(queue, cut_, range, group, {2 * planes, 0});
  plan_->forward(queue, planes_.get());
  opencl::set_argument(power_, 0, planes_.get());
  engine_.launch(queue, power_, cl::NDRange(opencl::round_up(side * (side / 2 + 1), 64), count),
                 cl::NDRange(64, 1), {2 * planes, 0});
  plan_->inverse(queue, planes_.get());
  opencl::set_argument(map_, argument++, levels_.get());
  opencl::set_argument(map_, argument++, planes_.get());
  opencl::set_argument(map_, argument++, sums_.get());
  opencl::set_argument(map_, argument++, maps_.get());
  opencl::set_argument(map_, argument++, contrast(frames));
  opencl::set_argument(map_, argument++, weights_.get());
  opencl::set_argument(map_, argument++, peaks_.get());
  opencl::set_argument(map_, argument++, static_cast<cl_uint>(at));
  engine_.launch(queue, map_, range, group, {planes, 0});
}

void ZnccOpencl::run(const DeviceFrames& frames, const opencl::Buffer<Window>& windows,
                     std::size_t count, opencl::Buffer<WindowMotion>& motions) {
  if (count > windows.size() || count > motions.size()) {
    throw InvalidArgument("more windows than their buffers hold");
  }
  if (variant_.path == ZnccPath::kBytes && frames.pixel_type() != PixelType::kU8) {
    if (!for_deep_pixels_) for_deep_pixels_ = make_for_deep_pixels(engine_, options_);
    for_deep_pixels_->run(frames, windows, count, motions);
    return;
  }
  peaks_.reserve(engine_, std::min(count, kMostPeaks));
  for (std::size_t start = 0; start < count; start += kMostPeaks) {
    const std::size_t part = std::min(count - start, kMostPeaks);
    if (variant_.path != ZnccPath::kClfft) {
      enqueue_fused(frames, windows, start, part);
    } else {
      reserve_batch(part);
      for (std::size_t at = 0; at < part; at += batch_) {
        enqueue_batch(frames, windows, start, at, std::min(batch_, part - at));
      }
    }
    int argument = 0;
    opencl::set_argument(subpixel_, argument++, peaks_.get());
    opencl::set_argument(subpixel_, argument++, static_cast<cl_uint>(start));
    opencl::set_argument(subpixel_, argument++, static_cast<cl_uint>(part));
    opencl::set_argument(subpixel_, argument++, static_cast<cl_float>(options_.min_correlation));
    opencl::set_argument(subpixel_, argument++,
                         static_cast<cl_float>(options_.window_px * options_.window_px));
    opencl::set_argument(subpixel_, argument++, motions.get());
    engine_.launch(
        engine_.queue(), subpixel_, cl::NDRange(opencl::round_up(part, 32)), cl::NDRange(32),
        {static_cast<double>(part) * (sizeof(CorrelationPeak) + sizeof(WindowMotion)), 0});
  }
}

}  // namespace impactdic::dic
