// One frame measured at once, while a person sets a measurement up.
#pragma once

#include <impactdic/device.h>

#include <atomic>
#include <cstdint>
#include <mutex>
#include <nlohmann/json_fwd.hpp>

#include "host/circle/scout_ball.h"
#include "host/view/page_request.h"
#include "host/view/shot.h"
#include "host/view/track_job.h"

namespace impactdic::view {

class FrameMeasurer {
 public:
  explicit FrameMeasurer(Session& session) : session_(session) {}

  // `frame` and the step to the next one, as a run of these two frames alone has them: {"frame",
  // "row": cells of track.csv by name, "columns" and "windows": as FieldFrames::frame has them,
  // "motion", "advice", "notes", "warnings", "ms"}. A run of the whole clip learns more (its noise,
  // rim and body), so that its figures differ within their deviations.
  //
  // `outline`: the circle alone, as soon as it is there; windows and advice are empty.
  //
  // Only the latest request counts: one that another has overtaken throws Overtaken. Throws as
  // `track`.
  nlohmann::json measure(const Shot& shot, TrackJob job, std::int64_t frame, bool outline);

 private:
  Session& session_;
  std::atomic<std::uint64_t> latest_ = 0;
  std::mutex mutex_;  // one at a time: each takes all cores; of what follows, too
  std::string looked_at_;
  std::optional<circle::Scouted> scouted_;  // in those frames
};

}  // namespace impactdic::view
