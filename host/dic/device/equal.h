// Equal windows by circular cross-correlation on an OpenCL device (kernels/equal/equal*.cl): the
// quickest way to a displacement, for small ones; see zncc_opencl.h for the unbiased method of
// `correlate`.
#pragma once

#include <string>
#include <vector>

#include "host/dic/field.h"
#include "host/dic/frames/device_frames.h"
#include "host/opencl/buffer.h"

namespace impactdic::dic {

// One way to compute the same. See kernels/lanes.h.
struct EqualVariant {
  int vector = 1, lanes = 32;
  int chain = 1;              // pictures after each other that a group follows its windows through
  bool width_known = false;   // the pictures' width compiled in
  bool warp_barrier = false;  // a group is one warp of an NVIDIA device
  int most_registers = 0;     // of a work-item, for NVIDIA's compiler; 0: its choice
  bool as_bytes = false;      // without transforms (kernels/equal/equal_bytes.cl): windows of 32 in
                              // 8-bit pictures (others go another way); 32 lanes, no chain
  bool matrix_units = false;  // of an NVIDIA device, which multiply matrices of bytes

  std::size_t local_bytes(int window_px) const;
  std::string name() const;
};

// Every variant that the device allows, the one to take without tuning first. window_px: 16 or 32.
std::vector<EqualVariant> equal_variants(const opencl::Device& device, int window_px);

// Real operations of a window, transforms counted as 5 N log2 N.
double equal_flops(int window_px);

// Pictures on the device as stored: (slots, height, width), and kBytesBehind bytes.
struct StoredPictures {
  const cl::Buffer& pixels;
  int width = 0, height = 0;
  PixelType type = PixelType::kU8;
  double full_scale = 255;  // grey level of white
};

class EqualOpencl {
 public:
  // Takes window_px (16 or 32), min_texture and min_correlation of `options`. Throws
  // InvalidArgument.
  EqualOpencl(opencl::Engine& engine, const FieldOptions& options, const EqualVariant& variant);

  // As ZnccOpencl::run. The guess moves the second window by whole pixels; a guessed rotation is
  // not looked at. period: the windows come in lists of so many, one after the other; where a list
  // begins in the pictures in which the one before ends, as with the frames of a clip, windows need
  // not be transformed twice. 0: one list. Never changes a result.
  void run(const DeviceFrames& frames, const opencl::Buffer<Window>& windows, std::size_t count,
           opencl::Buffer<WindowMotion>& motions, std::size_t period = 0);
  void run(const StoredPictures& pictures, const opencl::Buffer<Window>& windows, std::size_t count,
           opencl::Buffer<WindowMotion>& motions, std::size_t period = 0);

 private:
  void compile(const StoredPictures& pictures);
  // What pictures of this depth are measured with.
  EqualVariant variant_for(PixelType type) const;

  opencl::Engine& engine_;
  FieldOptions options_;
  EqualVariant variant_;
  cl::Kernel correlate_, finish_;
  opencl::Defines defines_;
  opencl::Buffer<EqualPeak> peaks_;
};

}  // namespace impactdic::dic
