#include "host/dic/frames/spline_frames.h"

#include <algorithm>

#include "host/dic/frames/spline_taps.h"
#include "host/opencl/arguments.h"
#include "kernels/frames/prefilter.h"
#include "kernels/spline.h"

namespace impactdic::dic {
namespace {

// Memory of the intermediate result, of as many frames as are filtered at once.
constexpr std::size_t kScratchBytes = std::size_t{32} << 20;

void zero(opencl::Engine& engine, const opencl::Buffer<float>& buffer) {
  try {
    engine.queue().enqueueFillBuffer(buffer.get(), 0.0f, 0, buffer.size() * sizeof(float));
  } catch (const cl::Error& error) {
    throw OpenClError(error.what(), error.err());
  }
}

}  // namespace

opencl::ProgramRequest SplineFrames::program(const opencl::Engine& engine, int degree,
                                             double presmooth_sigma_px,
                                             std::optional<Tiling> tiling) {
  const std::size_t radius = prefilter_taps(degree, presmooth_sigma_px).size() - 1;
  return {"frames/prefilter.cl",
          {{"SPLINE_DEGREE", std::to_string(degree)},
           {"RADIUS", std::to_string(radius)},
           {"VECTOR", std::to_string(choose_tiling(engine, tiling, 64).vector)}}};
}

SplineFrames::SplineFrames(opencl::Engine& engine, int degree, double presmooth_sigma_px, int slots,
                           std::optional<Tiling> tiling)
    : engine_(engine),
      degree_(degree),
      presmooth_sigma_px_(presmooth_sigma_px),
      tiling_(choose_tiling(engine, tiling, 64)),
      versions_(static_cast<std::size_t>(slots), 0) {
  const auto taps = prefilter_taps(degree, presmooth_sigma_px);
  radius_ = static_cast<int>(taps.size()) - 1;
  taps_ = opencl::make_buffer<float>(engine, std::vector<float>(taps.begin(), taps.end()));
  const opencl::ProgramRequest request = program(engine, degree, presmooth_sigma_px, tiling_);
  rows_kernel_ = engine.kernel(request, "prefilter_rows");
  columns_kernel_ = engine.kernel(request, "prefilter_columns");
  gradients_kernel_ = engine.kernel(request, "gradients");
}

void SplineFrames::allocate(const DeviceFrames& frames) {
  width_ = frames.width();
  height_ = frames.height();
  const auto vector = static_cast<std::size_t>(tiling_.vector);
  const std::size_t plane_pitch = opencl::round_up(static_cast<std::size_t>(width_), vector);
  const std::size_t pitch = opencl::round_up(plane_pitch + 2 * SPLINE_PAD,
                                             std::max<std::size_t>(vector, PREFILTER_ACROSS));
  const auto height = static_cast<std::size_t>(height_);
  const std::size_t count = versions_.size();
  plane_pitch_ = static_cast<int>(plane_pitch);
  pitch_ = static_cast<int>(pitch);
  const std::size_t frame = height * pitch;
  at_once_ = std::clamp<std::size_t>(kScratchBytes / (frame * sizeof(float)), 1, count);
  rows_ = opencl::Buffer<float>(engine_, at_once_ * frame);
  coefficients_ =
      opencl::Buffer<float>(engine_, (count * (height + 2 * SPLINE_PAD) + 2 * kGuardRows) * pitch);
  planes_ = opencl::Buffer<float>(engine_, count * 3 * height * plane_pitch + vector);
  device_changed_ = opencl::Buffer<cl_int>(engine_, count);
  // Idle lanes of vectors may read what no frame has filled yet.
  zero(engine_, coefficients_);
  zero(engine_, planes_);
}

void SplineFrames::prepare(const DeviceFrames& frames) {
  const auto is_new = [&](int slot) {
    return versions_[static_cast<std::size_t>(slot)] != frames.version(slot);
  };
  int fresh = 0;
  for (int slot = 0; slot < slots(); ++slot) fresh += is_new(slot) ? 1 : 0;
  if (fresh == 0) return;
  if (coefficients_.size() == 0) allocate(frames);
  changed_.clear();
  for (int slot = 0; slot < slots(); ++slot) {
    if (!is_new(slot)) continue;
    changed_.push_back(slot);
    versions_[static_cast<std::size_t>(slot)] = frames.version(slot);
  }
  device_changed_.write_later(engine_, changed_);
  for (std::size_t first = 0; first < changed_.size(); first += at_once_) {
    launch(frames, first, std::min(changed_.size() - first, at_once_));
  }
}

void SplineFrames::launch(const DeviceFrames& frames, std::size_t first, std::size_t count) {
  const bool wide = tiling_.vector == 1;
  const auto begin = static_cast<cl_int>(first);
  const auto vector = static_cast<std::size_t>(tiling_.vector);
  const auto pitch = static_cast<std::size_t>(pitch_), height = static_cast<std::size_t>(height_);
  const std::size_t lines = height + 2 * SPLINE_PAD;
  const double area = static_cast<double>(width_) * height_ * static_cast<double>(count);
  const opencl::WorkCount filter = {8 * area, area * (4.0 * radius_ + 2)};
  opencl::set_arguments(rows_kernel_, frames.images().get(), rows_.get(), taps_.get(),
                        device_changed_.get(), begin, width_, height_, pitch_);
  if (wide) {
    const std::size_t columns = (pitch + PREFILTER_ACROSS - 1) / PREFILTER_ACROSS;
    engine_.launch(engine_.queue(), rows_kernel_,
                   cl::NDRange(opencl::round_up(columns, PREFILTER_ITEMS),
                               opencl::round_up(height, PREFILTER_LINES), count),
                   cl::NDRange(PREFILTER_ITEMS, PREFILTER_LINES, 1), filter);
  } else {
    engine_.launch(engine_.queue(), rows_kernel_, cl::NDRange(1, height, count),
                   cl::NDRange(1, 1, 1), filter);
  }
  const std::size_t across = wide ? 64 : 1;
  const cl::NDRange local(across, 1, 1);
  const auto parts = [](std::size_t all, std::size_t part) { return (all + part - 1) / part; };
  opencl::set_arguments(columns_kernel_, rows_.get(), coefficients_.get(), taps_.get(),
                        device_changed_.get(), begin, height_, pitch_, coefficient_offset());
  engine_.launch(
      engine_.queue(), columns_kernel_,
      cl::NDRange(opencl::round_up(pitch / vector, across), parts(lines, PREFILTER_DOWN), count),
      local, filter);
  opencl::set_arguments(gradients_kernel_, coefficients_.get(), planes_.get(),
                        device_changed_.get(), begin, height_, pitch_, plane_pitch_,
                        coefficient_offset());
  const auto plane_pitch = static_cast<std::size_t>(plane_pitch_);
  engine_.launch(engine_.queue(), gradients_kernel_,
                 cl::NDRange(opencl::round_up(plane_pitch / vector, across),
                             parts(height, GRADIENT_DOWN), count),
                 local, {16 * area, area * (4.0 * degree_ * degree_ + 6.0 * degree_)});
}

}  // namespace impactdic::dic
