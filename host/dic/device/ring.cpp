#include "host/dic/device/ring.h"

#include <algorithm>
#include <limits>

#include "host/opencl/arguments.h"

namespace impactdic::dic {
namespace {

// Balls unwrapped at once: bounds the memory (0.8 MB a ball by default).
constexpr std::size_t kBatch = 16;

}  // namespace

RingRotation::RingRotation(opencl::Engine& engine, const RingOptions& options)
    : engine_(engine), options_((options.validate(), options)) {}

void RingRotation::prepare() {
  if (forward_) return;
  const auto angles = static_cast<std::size_t>(options_.angles);
  const auto rings = static_cast<std::size_t>(options_.rings);
  const opencl::Defines defines = {{"SPLINE_DEGREE", std::to_string(options_.spline_degree)}};
  unwrap_ = engine_.kernel("ring/ring.cl", "unwrap_rings", defines);
  sum_ = engine_.kernel("ring/ring.cl", "sum_rings", defines);
  tasks_ = opencl::Buffer<RingTask>(engine_, kBatch);
  missing_ = opencl::Buffer<cl_int>(engine_, kBatch);
  polar_ = opencl::Buffer<std::complex<float>>(engine_, kBatch * rings * angles);
  cross_ = opencl::Buffer<std::complex<float>>(engine_, kBatch * angles);
  energy_ = opencl::Buffer<std::complex<float>>(engine_, kBatch * angles);
  inverse_.emplace(engine_, angles, 1, kBatch);
  forward_.emplace(engine_, angles, 1, kBatch * rings);
}

std::vector<RingMotion> RingRotation::measure(DeviceFrames& frames,
                                              std::span<const RingTask> tasks) {
  for (const RingTask& task : tasks) {
    for (const int slot : {task.first, task.second}) {
      if (frames.version(slot) == 0) throw InvalidArgument("a frame slot is empty");
    }
    if (!(task.inner >= 0 && task.outer > task.inner)) {
      throw InvalidArgument("a ring's outer radius must be above its inner one");
    }
  }
  if (tasks.empty()) return {};
  prepare();
  const SplineFrames& splines = frames.splines(options_.spline_degree, options_.presmooth_sigma_px);
  std::vector<RingMotion> motions;
  motions.reserve(tasks.size());
  for (std::size_t first = 0; first < tasks.size(); first += kBatch) {
    measure_batch(splines, tasks.subspan(first, std::min(kBatch, tasks.size() - first)), motions);
  }
  return motions;
}

void RingRotation::measure_batch(const SplineFrames& splines, std::span<const RingTask> tasks,
                                 std::vector<RingMotion>& motions) {
  const auto angles = static_cast<std::size_t>(options_.angles);
  const auto rings = static_cast<std::size_t>(options_.rings);
  const std::size_t count = tasks.size();
  const std::size_t local = angles % 64 == 0 ? 64 : 1;
  tasks_.write(engine_, tasks);
  missing_.write(engine_, std::vector<cl_int>(count, 0));
  const double samples = static_cast<double>(count * rings * angles);
  const double taps = options_.spline_degree + 1.0;
  opencl::set_arguments(unwrap_, splines.coefficients().get(), splines.coefficient_offset(),
                        splines.width(), splines.height(), splines.pitch(), tasks_.get(),
                        polar_.get(), missing_.get());
  engine_.launch(engine_.queue(), unwrap_, cl::NDRange(angles, rings, count),
                 cl::NDRange(local, 1, 1), {16 * samples, 4 * samples * taps * taps});
  forward_->forward(engine_.queue(), polar_.get());
  opencl::set_arguments(sum_, polar_.get(), tasks_.get(), options_.rings, cross_.get(),
                        energy_.get());
  engine_.launch(engine_.queue(), sum_, cl::NDRange(angles, count), cl::NDRange(local, 1),
                 {16 * samples, 20 * samples});
  std::vector<std::complex<float>> cross(count * angles), energy(count * angles),
      correlation(count * angles);
  std::vector<cl_int> missing(count);
  cross_.read(engine_, cross);
  energy_.read(engine_, energy);
  missing_.read(engine_, missing);
  inverse_->inverse(engine_.queue(), cross_.get());
  cross_.read(engine_, correlation);
  for (std::size_t k = 0; k < count; ++k) {
    const auto part = [&](const std::vector<std::complex<float>>& all) {
      return std::span(all).subspan(k * angles, angles);
    };
    RingMotion motion =
        ring_peak({part(cross), part(energy), part(correlation)}, tasks[k], options_);
    if (missing[k] > 0) {
      motion.status = WindowStatus::kOutOfView;
      motion.rot_rad = motion.rot_sd_rad = std::numeric_limits<double>::quiet_NaN();
    }
    motions.push_back(motion);
  }
}

}  // namespace impactdic::dic
