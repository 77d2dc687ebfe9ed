// `track` on frames as a camera takes them: rows come out while it films.
#pragma once

#include <impactdic/clip.h>
#include <impactdic/control.h>
#include <impactdic/device.h>
#include <impactdic/export.h>
#include <impactdic/track.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace IMPACTDIC_PUBLIC impactdic {

// What gives frames one after the other: a pipe, a camera.
class FrameStream {
 public:
  virtual ~FrameStream() = default;
  // Size, bits and, where known, the rate. `frame_count` is 0.
  virtual const ClipInfo& info() const = 0;
  // Waits for the next frame; false at the end, or soon after `stop`. Called from one thread.
  // Throws FileError, FormatError.
  virtual bool next(Frame& frame) = 0;
  virtual void stop() = 0;  // from any thread
};

// Frames without gaps from a pipe or a file, "-": the standard input; grey, row-major, x right, y
// down. Throws InvalidArgument for an impossible layout, FileError where it cannot be opened.
std::shared_ptr<FrameStream> open_raw_stream(const std::string& path, const RawLayout& layout);

struct LiveRequest {
  // How frames are measured. `clip.fps` is the camera's rate, 1/s; `clip.source` and `frames` are
  // not looked at. Without `mm_per_px` rows are in px alone: a ball's diameter becomes a scale at
  // the end of a clip only.
  TrackRequest track;
  std::shared_ptr<FrameStream> stream;  // nullptr: of track.clip.paths and open.raw
  // Frames, 2 … 1000, in which texture, noise and the kind of body are looked at before the first
  // row, from the first ones that show a ball on.
  int look = 32;
  // Frames are measured in batches, of half as many as the camera takes in this time; a batch that
  // has waited for so long is measured as it is. Longer batches cost less a frame. 0.0005 … 1 s.
  double wait_s = 0.008;
  // Frames that would wait longer for their turn are dropped, the oldest first, so that rows do not
  // fall behind. 0: none is, and the sender waits. 0 … 60 s.
  double lag_s = 0.1;
  void validate() const;  // throws InvalidArgument
};

// One frame of the stream. `row.frame` counts all frames from 0, `row.time_s` goes by the stated
// rate. A pose's `origin` and `keyframe` count the frames that were not dropped.
struct LiveRow {
  const TrackRow& row;
  const SiScale& scale;
  bool dropped = false;  // not measured: `row` has its number and time alone
  double delay_s = 0;    // from its arrival to this call
};
// Called once a frame, in order, from one thread at a time.
using LiveSink = std::function<void(const LiveRow&)>;

struct LiveResult {
  std::int64_t frames = 0, dropped = 0, ok = 0;  // that came; of them
  std::int64_t short_batches = 0;                // measured before they were full
  double longest_delay_s = 0;
  double seconds = 0;       // from the first frame to the last row
  Body body = Body::kDisc;  // as which it was measured
  std::string body_reason;
  std::vector<std::string> warnings;
  bool cancelled = false;
};

// Measures until the stream ends or the run is cancelled. Memory does not grow with its length.
// Rows are the same as those of the same frames whenever they come, as long as none is dropped and
// no batch is short. Throws as `track` does, after the rows of the frames before.
LiveResult track_live(const LiveRequest& request, Session& session, const RunControl& control,
                      const LiveSink& sink);

}  // namespace impactdic
