// Displacements of interrogation windows between frames that are on the device already: the
// methods of FieldOptions behind one call.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "host/dic/device/equal.h"
#include "host/dic/device/icgn.h"
#include "host/dic/device/published.h"
#include "host/dic/device/zncc.h"
#include "host/dic/discs.h"
#include "host/dic/field.h"
#include "host/dic/frames/device_frames.h"
#include "host/dic/neighbours.h"

namespace impactdic::dic {

class WindowCorrelator {
 public:
  // `slots`: of the frames that `correlate` will get. `engine` must outlive the correlator. Throws
  // InvalidArgument for options that contradict each other.
  WindowCorrelator(opencl::Engine& engine, const FieldOptions& options, int slots);

  // The programs that it runs most on pictures of this depth, the largest first. `engine` may be
  // one that is not open yet (EngineOptions::expects).
  static std::vector<opencl::ProgramRequest> programs(const opencl::Engine& engine,
                                                      const FieldOptions& options, PixelType type);

  // Pixels of the picture in `slot` outside this disc do not count when it is a window's first
  // frame: IC-GN measures a window that the rim cuts over its part inside, if that is half of it.
  // The other methods take no notice. An infinite radius, the default, takes the disc away.
  void set_disc(int slot, double cx_px, double cy_px, double radius_px);

  // Measures every window; the result stands at the window's index. With IC-GN, what the
  // correlation does not find, or cannot judge because the rim cuts it, is sought from its
  // neighbours (neighbours.h). Throws InvalidArgument where a window names a slot without a frame.
  // The result stays until the next call.
  const std::vector<WindowMotion>& correlate(DeviceFrames& frames, std::span<const Window> windows);
  // The same, where it is known about where every window went (to a fraction of a speckle; `seeds`,
  // one a window, made by seed_at): IC-GN starts there, and the correlation searches only for what
  // that does not find. What was not searched for has no peak ratio. Other methods search.
  const std::vector<WindowMotion>& follow(DeviceFrames& frames, std::span<const Window> windows,
                                          std::span<const WindowMotion> seeds);
  // What the correlation alone says, IC-GN or not: to a few hundredths of a pixel, at a fraction of
  // the time. Windows that a disc cuts are masked.
  const std::vector<WindowMotion>& find(DeviceFrames& frames, std::span<const Window> windows);

 private:
  void check_frames(const DeviceFrames& frames, std::span<const Window> windows) const;
  // Seeds by correlation, and refines them where `refined`.
  void search(DeviceFrames& frames, std::span<const Window> windows,
              std::span<WindowMotion> motions, bool refined);
  void refine(DeviceFrames& frames, std::span<const Window> windows,
              std::span<const WindowMotion> seeds, std::span<WindowMotion> motions);
  // Searches for those of `results_` that were not found from their seeds.
  void search_lost(DeviceFrames& frames, std::span<const Window> windows);
  RefineWindows refining(DeviceFrames& frames);
  std::size_t at_once(std::size_t windows) const;  // go to the device

  opencl::Engine& engine_;
  int window_px_;
  // What the method takes; the others stay empty.
  std::optional<PublishedOpencl> published_;
  std::optional<EqualOpencl> equal_;
  std::optional<ZnccOpencl> zncc_;
  std::optional<IcgnRefiner> icgn_;
  opencl::Buffer<Window> windows_;
  opencl::Buffer<WindowMotion> motions_;
  Discs discs_;
  WholeWindows whole_;
  Neighbours neighbours_;
  std::vector<WindowMotion> results_;
  // What search_lost asks for.
  std::vector<std::size_t> lost_;
  std::vector<Window> lost_windows_;
  std::vector<WindowMotion> found_;
};

}  // namespace impactdic::dic
