// The turn of a sphere between two frames without a guess, up to half a turn about any axis
// (kernels/ball/sphere_search.cl): to a degree or two, for the registration to start from.
#pragma once

#include <vector>

#include "host/dic/frames/device_frames.h"
#include "kernels/types.h"

namespace impactdic::dic {

// score: ZNCC of the shrunk pictures, weighed by how much of the sphere both of them see.
struct SphereTurn {
  double w = 1, x = 0, y = 0, z = 0;  // unit quaternion, camera axes
  double score = 0;
};

class SphereSearch {
 public:
  // `engine` must outlive the search. Compiles nothing before the first `find`.
  explicit SphereSearch(opencl::Engine& engine) : engine_(engine) {}

  // The likeliest turns, best first, at most `most`, no two of them alike. Throws InvalidArgument
  // for a slot that is not there or a radius that is not positive.
  std::vector<SphereTurn> find(DeviceFrames& frames, const SphereSearchTask& task,
                               std::size_t most = 6);

 private:
  void prepare();
  void shrink(DeviceFrames& frames, const SphereSearchTask& task, int side);
  void score(std::vector<SphereTurn>& turns, int side);

  opencl::Engine& engine_;
  cl::Kernel shrink_, score_;
  std::vector<SphereTurn> everywhere_;  // evenly over SO(3)
  opencl::Buffer<float> maps_, scores_;
  opencl::Buffer<cl_float4> turns_;
};

// `count` turns spread evenly over SO(3): super-Fibonacci spirals (Alexa 2022, "Super-Fibonacci
// Spirals: Fast, Low-Discrepancy Sampling of SO(3)", Algorithm 1).
std::vector<SphereTurn> even_turns(int count);

}  // namespace impactdic::dic
