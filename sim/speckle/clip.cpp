#include "sim/speckle/clip.h"

#include <impactdic/error.h>
#include <tbb/task_arena.h>

#include <memory>
#include <optional>

#include "host/base/parallel/pipeline.h"

namespace impactdic::sim::speckle {

std::size_t render_clip(const FrameRenderer& renderer, std::span<const BallPose> poses,
                        double exposure, const std::function<void(const Frame&)>& consume,
                        const RunControl& control) {
  if (!(exposure >= 0 && exposure <= 1)) {
    throw InvalidArgument("the exposure is out of range", "exposure", "0 … 1 of a frame interval");
  }
  using Place = std::optional<std::size_t>;
  using FramePtr = std::shared_ptr<Frame>;
  std::size_t next = 0, done = 0;
  const auto in_flight = 2 * static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  run_pipeline(
      in_flight,
      [&]() -> Place {
        if (next == poses.size() || control.is_cancelled()) return {};
        return next++;
      },
      several_at_once([&](Place index) {
        auto frame = std::make_shared<Frame>();
        renderer.render(shutter_path(poses, *index, exposure), static_cast<std::int64_t>(*index),
                        *frame);
        return frame;
      }),
      in_order([&](const FramePtr& frame) {
        consume(*frame);
        ++done;
        if (control.progress) {
          control.progress(
              {"synth", static_cast<std::int64_t>(done), static_cast<std::int64_t>(poses.size())});
        }
      }));
  return done;
}

}  // namespace impactdic::sim::speckle
