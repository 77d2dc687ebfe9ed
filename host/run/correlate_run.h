// One run of `correlate`, in its steps: what `correlate` and `correlate_to_folder` share.
#pragma once

#include <impactdic/correlate.h>

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "host/pipeline/correlate_clip.h"
#include "host/run/camera/plane_motion.h"
#include "host/run/control.h"
#include "host/run/metres/noise_floor.h"

namespace impactdic::run {

class CorrelateRun {
 public:
  // Checks the request, opens clip and device, and lays out the windows. Everything must outlive
  // the run.
  CorrelateRun(const CorrelateRequest& request, Session& session, Caller& caller,
               CorrelateResult& result);

  const ClipInfo& info() const { return source_->info(); }
  const std::vector<Window>& windows() const { return windows_; }

  // Looks at the texture: the noise that windows are judged by, and the warnings.
  void look();

  // `plane`: as CorrelatedFrame's.
  using Sink = std::function<void(const MotionRow& row, std::span<const WindowMotion> field,
                                  std::span<const PlaneResult> plane)>;
  using Checkpoint = std::function<void(const pipeline::CorrelatePoint&)>;
  // Takes up an earlier run, whose rows are `rows`.
  void go_on(const pipeline::CorrelatePoint& from, std::vector<MotionRow> rows);
  // Measures. What was measured before an error is in the result. `checkpoint`, behind every frame,
  // gets where a run goes on that ends there.
  void measure(const Sink& sink, const Checkpoint& checkpoint = {});

 private:
  const CorrelateRequest& request_;
  Session& session_;
  Caller& caller_;
  CorrelateResult& result_;
  std::shared_ptr<FrameSource> source_;
  pipeline::CorrelateOptions options_;
  std::vector<Window> windows_;
  std::optional<PlaneMotion> plane_;
};

}  // namespace impactdic::run
