// The turn of a ball between two frames from rings about its centre (kernels/ring/ring.cl): any
// rotation up to half a turn either way, without a guess.
#pragma once

#include <complex>
#include <optional>
#include <span>
#include <vector>

#include "host/dic/field.h"
#include "host/dic/frames/device_frames.h"
#include "host/dic/frames/spline_frames.h"
#include "host/opencl/fft_plan.h"

namespace impactdic::dic {

struct RingOptions {
  int spline_degree = 7;            // 3, 5 or 7
  double presmooth_sigma_px = 0.5;  // Gaussian over both frames
  int rings = 96;
  int angles = 1024;  // samples of a ring; a product of small primes
  double min_correlation = 0.3;
  void validate() const;  // throws InvalidArgument
};

struct RingMotion {
  WindowStatus status = WindowStatus::kOk;
  double rot_rad = 0;  // counter-clockwise on screen, −π … π; NaN where it could not be measured
  double rot_sd_rad = 0;
  double correlation = 0;  // ZNCC at the rotation
  double peak_ratio = 0;   // over the highest correlation more than 3° away; at most 1000
};

// The sums over rings of one ball: cross[k] = conj(F_k) G_k and the energies |F_k|², |G_k|² at
// angular frequencies k = 0 … angles − 1, and correlation[j] = Σ cross[k] exp(2πi
// jk/angles)/angles.
struct RingSpectrum {
  std::span<const std::complex<float>> cross;
  std::span<const std::complex<float>> energy;  // real part |F|², imaginary part |G|²
  std::span<const std::complex<float>> correlation;
};
// Highest correlation, by Newton's method on the trigonometric polynomial through it. `task`,
// `options`: where the spectrum comes from.
RingMotion ring_peak(const RingSpectrum& spectrum, const RingTask& task,
                     const RingOptions& options);

class RingRotation {
 public:
  // `engine` must outlive the object. Throws InvalidArgument.
  RingRotation(opencl::Engine& engine, const RingOptions& options);

  // Measures every ball; the result stands at the task's index. Throws InvalidArgument for a slot
  // that is not there or radii that are no ring.
  std::vector<RingMotion> measure(DeviceFrames& frames, std::span<const RingTask> tasks);

 private:
  // Plans and memory, when they are first needed: clFFT takes milliseconds, and few clips lose
  // their windows.
  void prepare();
  void measure_batch(const SplineFrames& splines, std::span<const RingTask> tasks,
                     std::vector<RingMotion>& motions);

  opencl::Engine& engine_;
  RingOptions options_;
  cl::Kernel unwrap_, sum_;
  std::optional<opencl::FftPlan> forward_, inverse_;
  opencl::Buffer<RingTask> tasks_;
  opencl::Buffer<std::complex<float>> polar_, cross_, energy_;
  opencl::Buffer<cl_int> missing_;
};

// The same in double precision by the definitions, for tests. Slow.
RingMotion ring_reference(const Frame& first, const Frame& second, const RingTask& task,
                          const RingOptions& options);

}  // namespace impactdic::dic
