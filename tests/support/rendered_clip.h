// A clip of a rendered ball that is never written: frames are computed when they are read.
#pragma once

#include <vector>

#include "host/pipeline/track_clip.h"
#include "host/video/frame_source.h"
#include "sim/speckle/render.h"
#include "tests/support/engine.h"
#include "tests/support/motion_truth.h"

namespace impactdic::testing {

class RenderedClip : public FrameSource {
 public:
  RenderedClip(const sim::speckle::SpeckleBall& ball, const SynthScene& scene,
               std::vector<BallPose> poses)
      : renderer_(ball, scene), poses_(std::move(poses)) {
    info_.format = "rendered";
    info_.width = scene.width;
    info_.height = scene.height;
    info_.bits = scene.bits;
    info_.frame_count = static_cast<std::int64_t>(poses_.size());
  }
  const ClipInfo& info() const override { return info_; }
  void read(std::int64_t index, Frame& frame) override {
    renderer_.render(poses_[static_cast<std::size_t>(index)], index, frame);
  }
  const std::vector<BallPose>& poses() const { return poses_; }

 private:
  sim::speckle::BallRenderer renderer_;
  std::vector<BallPose> poses_;
  ClipInfo info_;
};

class MemoryClip : public FrameSource {
 public:
  explicit MemoryClip(std::vector<Frame> frames) : frames_(std::move(frames)) {
    info_.format = "memory";
    info_.width = frames_[0].width();
    info_.height = frames_[0].height();
    info_.bits = frames_[0].bits;
    info_.frame_count = static_cast<std::int64_t>(frames_.size());
  }
  const ClipInfo& info() const override { return info_; }
  void read(std::int64_t index, Frame& frame) override {
    frame = frames_[static_cast<std::size_t>(index)];
  }

 private:
  std::vector<Frame> frames_;
  ClipInfo info_;
};

// The rows of `track` with these options, but for the frames, which are all.
inline std::vector<TrackRow> track(FrameSource& clip, pipeline::TrackOptions options) {
  options.frames = {0, clip.info().frame_count, 1};
  options.roi = {0, 0, clip.info().width, clip.info().height};
  std::vector<TrackRow> rows;
  opencl::Engine* const engines[] = {&shared_engine()};
  pipeline::track_clip(
      clip, engines, options, [](std::span<const Window>, double) {},
      [&](const pipeline::TrackedFrame& frame) { rows.push_back(frame.row); },
      [](std::int64_t, std::int64_t) {});
  return rows;
}

// The same with this estimator.
inline std::vector<TrackRow> track(FrameSource& clip, Estimator estimator) {
  pipeline::TrackOptions options;
  options.estimator.estimator = estimator;
  return track(clip, options);
}

// Errors of rows 1 … against the truth. Poses are held against where the material point went that
// was measured to be the centre in the first frame; steps are summed up.
struct DriftErrors {
  Errors x, y, angle_deg;                                // of the poses
  double sum_x_px = 0, sum_y_px = 0, sum_angle_deg = 0;  // of all steps, at the end
  double end_x_px = 0, end_y_px = 0, end_angle_deg = 0;  // of the last pose
  int lost = 0;
};
inline DriftErrors drift(const std::vector<TrackRow>& rows, const std::vector<BallPose>& truth) {
  DriftErrors out;
  const double ex = rows[0].cx_px - truth[0].cx_px, ey = rows[0].cy_px - truth[0].cy_px;
  // Steps are summed up as motions of that same point.
  double x = rows[0].cx_px, y = rows[0].cy_px, angle_deg = 0;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const TrackRow& last = rows[k - 1];
    const double turn_deg = truth[k].angle_deg - truth[0].angle_deg;
    const double c = std::cos(turn_deg * kRadPerDeg), s = std::sin(turn_deg * kRadPerDeg);
    const double true_x = truth[k].cx_px + c * ex + s * ey;
    const double true_y = truth[k].cy_px - s * ex + c * ey;
    const double turn_rad = last.rot_deg * kRadPerDeg;
    const double ac = std::cos(turn_rad), as = std::sin(turn_rad);
    const double arm_x = x - last.cx_px, arm_y = y - last.cy_px;
    x = last.cx_px + last.dx_px + ac * arm_x + as * arm_y;
    y = last.cy_px + last.dy_px - as * arm_x + ac * arm_y;
    angle_deg += last.rot_deg;
    out.sum_x_px = x - true_x;
    out.sum_y_px = y - true_y;
    out.sum_angle_deg = angle_deg - turn_deg;
    const BodyPose& pose = rows[k].pose;
    if (!pose.ok || pose.origin != 0) {
      ++out.lost;
      continue;
    }
    out.x.add(out.end_x_px = pose.x_px - true_x, pose.x_sd_px);
    out.y.add(out.end_y_px = pose.y_px - true_y, pose.y_sd_px);
    out.angle_deg.add(out.end_angle_deg = pose.angle_rad * kDegPerRad - turn_deg,
                      pose.angle_sd_rad * kDegPerRad);
  }
  return out;
}

}  // namespace impactdic::testing
