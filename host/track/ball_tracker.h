// The ball over the frames of a clip: predicts, measures, finds again after a loss.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "host/base/image.h"
#include "host/track/circle.h"

namespace impactdic {

struct BallTrackerOptions {
  CircleOptions circle;
  std::optional<double> compression_axis_rad;  // normal of the surface that is hit, image axes
  std::optional<double> scouted_radius_px;     // roughly: another circle is not this ball
  void validate() const;
};

// Follows one ball through frames in order (of time; a step back or a gap is allowed). Predicts
// with constant velocity from the last two measured frames, measures (measure_circle), and looks
// in the whole picture (find_ball) in the first frame and after a loss. Learns the free ball's
// radius as the median of what it measured while the ball was round, and its polarity.
//
// Not for use from several threads; a long clip is spread over threads by one tracker for each run
// of frames (BallTracker::hint carries what is known to the next run).
class BallTracker {
 public:
  explicit BallTracker(BallTrackerOptions options = {});

  // Measures the ball in `frame`, which is frame number `index` of the clip. A frame without a
  // ball says so in its status; the tracker goes on.
  CircleFit track(const Frame& frame, std::int64_t index);

  // What is expected of frame `index`; nullopt where nothing is known.
  std::optional<CirclePrior> predict(std::int64_t index) const;

  // Starts from another tracker's measurement of frame `index`.
  void hint(const CircleFit& fit, std::int64_t index);

  // The free ball's radius so far, and the scatter of that.
  std::optional<double> radius_px() const;
  double radius_sd_px() const;

 private:
  struct Seen {
    std::int64_t index;
    CircleFit fit;
  };
  void remember(const CircleFit& fit, std::int64_t index);
  bool plausible(const CircleFit& fit) const;
  std::optional<double> rough_radius_px() const;

  BallTrackerOptions options_;
  std::deque<Seen> seen_;        // the last measured frames, newest last
  std::deque<double> radii_px_;  // of the last frames in which the ball was round and whole
};

}  // namespace impactdic
