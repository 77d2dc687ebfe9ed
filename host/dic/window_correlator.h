// Displacements of interrogation windows between frames that are on the device already: the
// methods of FieldOptions behind one call.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "host/dic/device_frames.h"
#include "host/dic/field.h"
#include "host/dic/icgn_opencl.h"
#include "host/dic/published_opencl.h"
#include "host/dic/zncc_opencl.h"

namespace impactdic {

class WindowCorrelator {
 public:
  // `slots`: of the frames that `correlate` will get. `engine` must outlive the correlator. Throws
  // InvalidArgument for options that contradict each other.
  WindowCorrelator(Engine& engine, const FieldOptions& options, int slots);

  // Measures every window; the result stands at the window's index. Throws InvalidArgument where a
  // window names a slot without a frame.
  std::vector<WindowMotion> correlate(DeviceFrames& frames, std::span<const Window> windows);

 private:
  Engine& engine_;
  // What the method takes; the others stay empty.
  std::optional<PublishedOpencl> published_;
  std::optional<ZnccOpencl> zncc_;
  std::optional<IcgnRefiner> icgn_;
  Buffer<Window> windows_;
  Buffer<WindowMotion> motions_;
};

}  // namespace impactdic
