// Reads the analysed frames of a clip, a batch at a time, decoding ahead on other threads. Every
// stage is bounded: memory does not grow with the clip.
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "host/clip/frame_range.h"
#include "host/clip/roi.h"
#include "host/video/frame_source.h"

namespace impactdic::pipeline {

struct FrameBatch {
  std::int64_t first_index = 0;  // of frames[0] among the analysed frames
  std::vector<Frame> frames;     // cropped to the region of interest
  std::vector<bool> repeats;     // whether a frame is the picture of the one before it once more
  std::exception_ptr error;      // why the frame after these could not be read
};

// Fills in `repeats`; of the first frame nothing is known here.
void note_repeats(FrameBatch& batch);

// Hands out the batches of a clip in order. Batches that nobody holds any more lend their memory
// to the next ones.
class BatchReader {
 public:
  // `batch` frames each, from analysed frame `first_index` on. `source` must outlive the reader.
  BatchReader(FrameSource& source, const FrameRange& range, std::int64_t first_index,
              const Roi& roi, int batch);

  // The next batch, not yet decoded; nullptr at the end. Not for several threads at once.
  std::shared_ptr<FrameBatch> next();
  // Reads the frames of a batch; safe for several batches at once. An error is noted in the batch,
  // which then ends with the frame before.
  void decode(FrameBatch& batch);

 private:
  struct Pool {
    std::mutex mutex;
    std::vector<std::unique_ptr<FrameBatch>> free;
  };
  FrameSource& source_;
  FrameRange range_;
  std::int64_t next_;
  Roi roi_;
  int batch_;
  bool whole_;
  std::shared_ptr<Pool> pool_ = std::make_shared<Pool>();
};

// Calls `consume` with every batch in order, on one thread at a time; up to `batch` frames each,
// from analysed frame `first_index` on. Two batches are decoded ahead. An error of the reader
// comes out of this call after the frames before it have been consumed.
void for_each_batch(FrameSource& source, const FrameRange& range, std::int64_t first_index,
                    const Roi& roi, int batch, const std::function<void(FrameBatch&)>& consume);

}  // namespace impactdic::pipeline
