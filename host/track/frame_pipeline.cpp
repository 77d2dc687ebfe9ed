#include "host/track/frame_pipeline.h"

#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <memory>

namespace impactdic {

void for_each_batch(FrameSource& source, const FrameRange& range, std::int64_t first_index,
                    const Roi& roi, int batch, const std::function<void(FrameBatch&)>& consume) {
  constexpr std::size_t kBatchesInFlight = 3;
  const VideoInfo& info = source.info();
  const bool whole =
      roi.x == 0 && roi.y == 0 && roi.width == info.width && roi.height == info.height;
  std::int64_t next = first_index;
  const auto hand_out = [&](tbb::flow_control& control) -> std::shared_ptr<FrameBatch> {
    if (next >= range.count()) {
      control.stop();
      return nullptr;
    }
    auto made = std::make_shared<FrameBatch>();
    made->first_index = next;
    made->frames.resize(
        static_cast<std::size_t>(std::min<std::int64_t>(batch, range.count() - next)));
    next += batch;
    return made;
  };
  const auto decode = [&](std::shared_ptr<FrameBatch> made) {
    Frame full;
    for (std::size_t i = 0; i < made->frames.size(); ++i) {
      const std::int64_t index = range.at(made->first_index + static_cast<std::int64_t>(i));
      try {
        source.read(index, whole ? made->frames[i] : full);
      } catch (...) {
        made->error = std::current_exception();
        made->frames.resize(i);
        break;
      }
      if (!whole) crop(full, roi, made->frames[i]);
    }
    return made;
  };
  tbb::parallel_pipeline(
      kBatchesInFlight,
      tbb::make_filter<void, std::shared_ptr<FrameBatch>>(tbb::filter_mode::serial_in_order,
                                                          hand_out) &
          tbb::make_filter<std::shared_ptr<FrameBatch>, std::shared_ptr<FrameBatch>>(
              tbb::filter_mode::parallel, decode) &
          tbb::make_filter<std::shared_ptr<FrameBatch>, void>(
              tbb::filter_mode::serial_in_order, [&](const std::shared_ptr<FrameBatch>& made) {
                if (!made->frames.empty()) consume(*made);
                if (made->error) std::rethrow_exception(made->error);
              }));
}

}  // namespace impactdic
