#include "host/pipeline/frame_pipeline.h"

#include <algorithm>

#include "host/base/parallel/pipeline.h"
#include "host/pipeline/rows/repeated_frames.h"

namespace impactdic::pipeline {

BatchReader::BatchReader(FrameSource& source, const FrameRange& range, std::int64_t first_index,
                         const Roi& roi, int batch)
    : source_(source), range_(range), next_(first_index), roi_(roi), batch_(batch) {
  const ClipInfo& info = source.info();
  whole_ = roi.x == 0 && roi.y == 0 && roi.width == info.width && roi.height == info.height;
}

std::shared_ptr<FrameBatch> BatchReader::next() {
  if (next_ >= range_.count()) return nullptr;
  std::unique_ptr<FrameBatch> made;
  {
    const std::lock_guard<std::mutex> lock(pool_->mutex);
    if (!pool_->free.empty()) {
      made = std::move(pool_->free.back());
      pool_->free.pop_back();
    }
  }
  if (!made) made = std::make_unique<FrameBatch>();
  made->first_index = next_;
  made->error = nullptr;
  made->frames.resize(
      static_cast<std::size_t>(std::min<std::int64_t>(batch_, range_.count() - next_)));
  next_ += batch_;
  return {made.release(), [pool = pool_](FrameBatch* batch) {
            const std::lock_guard<std::mutex> lock(pool->mutex);
            pool->free.emplace_back(batch);
          }};
}

void BatchReader::decode(FrameBatch& batch) {
  Frame full;
  for (std::size_t i = 0; i < batch.frames.size(); ++i) {
    const std::int64_t index = range_.at(batch.first_index + static_cast<std::int64_t>(i));
    try {
      source_.read(index, whole_ ? batch.frames[i] : full);
    } catch (...) {
      batch.error = std::current_exception();
      batch.frames.resize(i);
      break;
    }
    if (!whole_) crop(full, roi_, batch.frames[i]);
  }
  note_repeats(batch);
}

void note_repeats(FrameBatch& batch) {
  batch.repeats.assign(batch.frames.size(), false);
  for (std::size_t i = 1; i < batch.frames.size(); ++i) {
    batch.repeats[i] = is_same_picture(batch.frames[i - 1], batch.frames[i]);
  }
}

void for_each_batch(FrameSource& source, const FrameRange& range, std::int64_t first_index,
                    const Roi& roi, int batch, const std::function<void(FrameBatch&)>& consume) {
  constexpr std::size_t kBatchesInFlight = 3;
  BatchReader reader(source, range, first_index, roi, batch);
  run_pipeline(
      kBatchesInFlight, [&] { return reader.next(); },
      several_at_once([&](std::shared_ptr<FrameBatch> made) {
        reader.decode(*made);
        return made;
      }),
      in_order([&](const std::shared_ptr<FrameBatch>& made) {
        if (!made->frames.empty()) consume(*made);
        if (made->error) std::rethrow_exception(made->error);
      }));
}

}  // namespace impactdic::pipeline
