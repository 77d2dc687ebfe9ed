// Displacements of interrogation windows between frames: one interface, the double-precision
// reference on the host and the OpenCL device behind it.
#pragma once

#include <impactdic/image.h>

#include <memory>
#include <span>
#include <vector>

#include "host/dic/field.h"

namespace impactdic::opencl {
class Engine;
}  // namespace impactdic::opencl

namespace impactdic::dic {

class Correlator {
 public:
  virtual ~Correlator() = default;
  // Puts a frame into slot `slot` (0 … slots − 1), replacing what was there. The first frame sets
  // the size; another size throws InvalidArgument.
  virtual void set_frame(int slot, const Frame& frame) = 0;
  // Pixels of the picture in `slot` outside this disc do not count when it is a window's first
  // frame: IC-GN measures a window that the rim cuts over its part inside, if that is half of it.
  // The other methods take no notice. An infinite radius, the default, takes the disc away.
  virtual void set_disc(int slot, double cx_px, double cy_px, double radius_px) = 0;
  // Measures every window; the result stands at the window's index. Windows may name any slots
  // that hold a frame. A window that cannot be measured has a status, never an exception. With
  // IC-GN, what the correlation does not find is sought from its neighbours (neighbours.h).
  virtual std::vector<WindowMotion> correlate(std::span<const Window> windows) = 0;
};

// Plain double-precision implementation of every method, one window at a time: what the kernels
// are tested against. Slow.
std::unique_ptr<Correlator> make_reference_correlator(const FieldOptions& options, int slots);

// The same on an OpenCL device. `engine` must outlive the correlator.
std::unique_ptr<Correlator> make_opencl_correlator(opencl::Engine& engine,
                                                   const FieldOptions& options, int slots);

}  // namespace impactdic::dic
