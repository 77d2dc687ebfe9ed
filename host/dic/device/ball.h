// The motion of a whole ball between two frames by one registration (kernels/ball/rigid.cl): every
// pixel of the disc counts, so that it is several times as exact as a fit to a field of windows.
#pragma once

#include <impactdic/image.h>

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "host/dic/field.h"
#include "host/dic/frames/device_frames.h"
#include "host/dic/frames/spline_frames.h"
#include "host/dic/rim_margin.h"

namespace impactdic::dic {

// What a ball's picture may do between two frames: move and turn in its plane, also deform (a ball
// under compression), or be that of a sphere, which turns about any axis, its radius known or found
// along with its motion, or this and the camera's distance found: its tasks name one to begin with.
enum class BallModel { kRigid, kAffine, kSphere, kSphereAndRadius, kSphereRadiusAndDistance };

struct BallOptions {
  BallModel model = BallModel::kRigid;
  // Of a sphere: the centre in the first picture is found along with its motion, as far as both the
  // pictures and BallTask.centre_sd say. A turn shows it: a point beside the centre it is thought
  // to have lies at another depth.
  bool free_centre = false;
  bool lit = false;       // of a sphere: the light that its tasks tell of (BallTask.light) counts
  bool robust = true;     // Tukey's biweight against what does not move with the ball
  int spline_degree = 7;  // 3, 5 or 7
  double presmooth_sigma_px = 0.5;  // Gaussian over both frames: halves the interpolation's bias
  int max_steps = 30;
  double min_correlation = 0.6;  // ZNCC below which a ball is low_correlation
  double min_texture = 1.0;      // rms contrast, grey levels of 255, below which it is no_texture
  // Which pixels of the first picture count (not 0): an image of the whole pictures, of which the
  // frames may be parts; nullptr: all of the disc. A mask may be the body, so that shares
  // are of its pixels, or say what hides a part of the disc.
  std::shared_ptr<const Image<std::uint8_t>> mask;
  bool mask_is_body = false;
  void validate() const;  // throws InvalidArgument
};

class BallRegistration {
 public:
  // `engine` must outlive the registration. Throws InvalidArgument.
  BallRegistration(opencl::Engine& engine, const BallOptions& options,
                   std::optional<Tiling> tiling = {});

  // What registers round balls seen by parallel rays, or `shaped` ones (BallTask::sight) otherwise.
  // `engine` may be one that is not open yet (EngineOptions::expects).
  static opencl::ProgramRequest program(const opencl::Engine& engine, const BallOptions& options,
                                        bool shaped, std::optional<Tiling> tiling = {});

  // Measures every ball; the result stands at the task's index. The guess must be within about
  // 3 px and 3° of the motion (of a sphere, at its surface, within a speckle's size). Throws
  // InvalidArgument for a slot that is not there, for a sphere without its radius, where a ball
  // that is no sphere is to be seen in perspective, and where a distance that is to be found has
  // nothing to begin with, or a centre no deviation.
  std::vector<BallMotion> measure(DeviceFrames& frames, std::span<const BallTask> tasks);

 private:
  opencl::Engine& engine_;
  BallOptions options_;
  Tiling tiling_;
  // Of round balls seen by parallel rays, and of those that task.sight tells of: compiled for the
  // first such ball.
  std::array<cl::Kernel, 2> kernels_;
  cl::Kernel& kernel(bool shaped);
  // Balls of one kind.
  std::vector<BallMotion> launch(DeviceFrames& frames, std::span<const BallTask> tasks,
                                 bool shaped);
  bool is_masked() const { return options_.mask != nullptr; }
  void write_mask();
  double checked_pixels(const DeviceFrames& frames, std::span<const BallTask> tasks) const;
  // Of what the slots hold, of masked registrations.
  std::vector<cl_int2> corners_of(const DeviceFrames& frames) const;
  opencl::Buffer<float> smooth_taps_, mask_;
  float mask_area_ = 0;
  opencl::Buffer<cl_int2> corners_;
  opencl::Buffer<BallTask> tasks_;
  opencl::Buffer<BallMotion> motions_;
  cl_float4 noise_;
};

}  // namespace impactdic::dic
