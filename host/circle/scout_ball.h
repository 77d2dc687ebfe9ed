// The ball in a few frames spread over a clip, before the run.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "host/circle/circle.h"
#include "host/clip/frame_range.h"
#include "host/clip/roi.h"
#include "host/video/frame_source.h"

namespace impactdic::circle {

// A ball as several frames show it.
struct BallCandidate {
  struct Sighting {
    std::int64_t index = 0;  // of the frame among those of the range
    FoundBall ball;
  };
  double radius_px = 0;             // median
  double moved_px = 0;              // between the two sightings farthest apart
  double rim_fraction = 0;          // mean
  double score = 0;                 // length of rim seen in all frames
  std::vector<Sighting> sightings;  // in order of time
};

struct Scouted {
  int frames = 0;  // looked at
  // What stands still; nullptr where nothing can be said of that.
  std::shared_ptr<const StillScene> scene;
  bool still = false;  // nothing moves, though there are frames enough to tell
  // What lies behind the best ball; nullptr where that is even, or nothing can be said of it.
  std::shared_ptr<const Backdrop> backdrop;
  // The best first. Frames that show most of a rim agree on each of them.
  std::vector<BallCandidate> balls;
  // The ball's radius; nullopt where no frame shows a ball well enough. A ball that enters the
  // picture shows blobs of speckle before it shows its rim: whoever knows the radius is not taken
  // in by them.
  std::optional<double> radius_px() const;
  // Whether the candidate is believed to be a ball: frames enough show it, and it moves or shows
  // most of its rim. Speckles, holes and hubs hold circles, too.
  bool is_believed(const BallCandidate& ball) const;
  // Whether it moves by more than what rests seems to.
  static bool moves(const BallCandidate& ball);
  // Those that are believed, the best first.
  std::vector<const BallCandidate*> believed() const;
  // To follow `ball`, one of those, and none of the others that are believed; nullptr where there
  // is no other.
  std::shared_ptr<const BallChoice> choose(const BallCandidate& ball) const;
  // A thing that never moves is not the ball where another does that is as plain, even if what
  // moves passes so near that the scene does not call the thing still.
  void put_mover_first();
  // Whether another one that is believed rests while the best one moves.
  bool rests_beside_the_best() const;
  // A ball beside the best one; nullptr where there is none.
  const BallCandidate* second_ball() const;
};

// Takes 12 frames of the range, more (48 at most) where these do not agree. Reads and searches on
// several threads. A frame that cannot be read shows no ball. A thing that never moves, while
// others do, is no ball.
Scouted scout_ball(FrameSource& source, const FrameRange& range, const Roi& roi,
                   const CircleOptions& options);

}  // namespace impactdic::circle
