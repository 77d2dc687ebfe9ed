#include "host/dic/device/published.h"

#include <algorithm>
#include <vector>

#include "host/dic/frames/cubic_spline.h"
#include "host/dic/reference/zncc.h"
#include "host/opencl/arguments.h"

namespace impactdic::dic {
namespace {

constexpr std::size_t kPublishedScratchBytes = std::size_t{64} << 20;

// As in published.cl.
std::size_t scratch_floats(int window_px) {
  const auto side = static_cast<std::size_t>(window_px), lags = 2 * side - 1;
  return 4 * side * side + lags * lags;
}

}  // namespace

PublishedOpencl::PublishedOpencl(opencl::Engine& engine, const FieldOptions& options)
    : engine_(engine), options_(options), group_(engine.device().is_gpu ? 64 : 1) {
  const std::vector<double> exact = lag_matrices(options.window_px, options.interp_points);
  matrices_ =
      opencl::make_buffer<cl_float>(engine, std::vector<cl_float>(exact.begin(), exact.end()));
  kernel_ = engine.kernel(
      "published/published.cl", "published",
      {{"WINDOW_PX", std::to_string(options.window_px)}, {"GROUP", std::to_string(group_)}});
}

void PublishedOpencl::run(const DeviceFrames& frames, const opencl::Buffer<Window>& windows,
                          std::size_t count, opencl::Buffer<WindowMotion>& motions) {
  if (count > windows.size() || count > motions.size()) {
    throw InvalidArgument("more windows than their buffers hold");
  }
  const std::size_t floats = scratch_floats(options_.window_px);
  const std::size_t most = std::max<std::size_t>(1, kPublishedScratchBytes / (4 * floats));
  scratch_.reserve(engine_, std::min(count, most) * floats);
  for (std::size_t start = 0; start < count; start += most) {
    const std::size_t part = std::min(most, count - start);
    int argument = 0;
    opencl::set_argument(kernel_, argument++, frames.images().get());
    opencl::set_argument(kernel_, argument++, static_cast<cl_int>(frames.width()));
    opencl::set_argument(kernel_, argument++, static_cast<cl_int>(frames.height()));
    opencl::set_argument(kernel_, argument++, windows.get());
    opencl::set_argument(kernel_, argument++, static_cast<cl_uint>(start));
    opencl::set_argument(kernel_, argument++, matrices_.get());
    opencl::set_argument(kernel_, argument++, static_cast<cl_int>(options_.interp_points + 1));
    opencl::set_argument(kernel_, argument++,
                         static_cast<cl_float>(min_contrast(options_, frames.full_scale())));
    opencl::set_argument(kernel_, argument++, scratch_.get());
    opencl::set_argument(kernel_, argument++, motions.get());
    engine_.launch(engine_.queue(), kernel_, cl::NDRange(part * group_), cl::NDRange(group_));
  }
}

}  // namespace impactdic::dic
