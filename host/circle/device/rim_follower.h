// Rims that lie where they are expected, followed on a device (kernels/rim/follow.cl) by the rim
// model of earlier frames: what `follow` does of a disc, for many frames at once. Whatever does not
// settle there at once is left to `measure_circle`.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "host/circle/circle.h"
#include "host/dic/frames/device_frames.h"
#include "host/opencl/buffer.h"
#include "kernels/rim/rim.h"

namespace impactdic::circle {

// A frame of which a part, with its corner at (x, y), lies in a slot.
struct RimToFollow {
  const Frame* frame = nullptr;
  int slot = 0, x = 0, y = 0;
  CirclePrior prior;
};

class RimFollower {
 public:
  // `engine` must outlive the object.
  RimFollower(opencl::Engine& engine, const CircleOptions& options);
  // What is compiled for pictures of this depth.
  static opencl::ProgramRequest program(const CircleOptions& options, PixelType type);
  // Clips with at least so many frames gain more than it takes to compile it once.
  static constexpr std::int64_t kLongClip = 4096;
  // Whether such a device and such circles are for it.
  static bool serves(const opencl::Device& device, const CircleOptions& options);
  // Whether a rim like that is followed at once: a disc's, known well enough.
  static bool takes(const CirclePrior& prior);

  // One fit for each, as measure_circle gives it; nullopt where the device does not tell. Throws
  // OpenClError.
  std::vector<std::optional<CircleFit>> follow(const dic::DeviceFrames& frames,
                                               std::span<const RimToFollow> rims);

 private:
  std::optional<RimTask> task_of(const dic::DeviceFrames& frames, const RimToFollow& rim) const;
  std::optional<CircleFit> fit_of(const RimToFollow& rim, const RimTask& task,
                                  const RimFound& found) const;
  std::vector<RimFound> run(const dic::DeviceFrames& frames,
                            const std::shared_ptr<const RimModel>& model,
                            std::span<const RimTask> tasks);

  opencl::Engine& engine_;
  CircleOptions options_;
  cl::Kernel kernel_;
  std::shared_ptr<const RimModel> model_;  // that the device has
  opencl::Buffer<float> model_numbers_, room_;
  opencl::Buffer<RimNumbers> numbers_;
  opencl::Buffer<RimTask> tasks_;
  opencl::Buffer<RimFound> found_;
};

}  // namespace impactdic::circle
