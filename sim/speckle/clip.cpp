#include "sim/speckle/clip.h"

#include <impactdic/error.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <memory>

namespace impactdic::sim::speckle {

std::size_t render_clip(const FrameRenderer& renderer, std::span<const BallPose> poses,
                        double exposure, const std::function<void(const Frame&)>& consume,
                        const RunControl& control) {
  if (!(exposure >= 0 && exposure <= 1)) {
    throw InvalidArgument("the exposure is out of range", "exposure", "0 … 1 of a frame interval");
  }
  using FramePtr = std::shared_ptr<Frame>;
  std::size_t next = 0, done = 0;
  const auto in_flight = 2 * static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  tbb::parallel_pipeline(
      in_flight,
      tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order,
                                          [&](tbb::flow_control& flow) -> std::size_t {
                                            if (next == poses.size() || control.is_cancelled())
                                              flow.stop();
                                            return next++;
                                          }) &
          tbb::make_filter<std::size_t, FramePtr>(tbb::filter_mode::parallel,
                                                  [&](std::size_t index) {
                                                    auto frame = std::make_shared<Frame>();
                                                    renderer.render(
                                                        shutter_path(poses, index, exposure),
                                                        static_cast<std::int64_t>(index), *frame);
                                                    return frame;
                                                  }) &
          tbb::make_filter<FramePtr, void>(
              tbb::filter_mode::serial_in_order, [&](const FramePtr& frame) {
                consume(*frame);
                ++done;
                if (control.progress) {
                  control.progress({"synth", static_cast<std::int64_t>(done),
                                    static_cast<std::int64_t>(poses.size())});
                }
              }));
  return done;
}

}  // namespace impactdic::sim::speckle
