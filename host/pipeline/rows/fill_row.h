// From what was measured of a frame to its row.
#pragma once

#include <impactdic/clip.h>

#include <span>

#include "host/circle/circle.h"
#include "host/clip/track_row.h"
#include "host/dic/rigid_fit.h"
#include "host/motion/ball_shape.h"
#include "host/motion/motion_estimator.h"

namespace impactdic::pipeline {

// The row of the frame `index` among the analysed ones, as long as no ball is seen in it. `fps`: of
// the stored frames; `periods`: see TrackOptions.
TrackRow row_without_ball(const FrameRange& frames, double fps,
                          std::span<const std::int64_t> periods, std::int64_t index);
void set_circle(TrackRow& row, const circle::CircleFit& fit);
// After set_circle: the circle's deviations are a part of the motion's, which is the centre's,
// while the ball turns about it and its picture is stretched by `stretch`. `light`: on a sphere,
// where it is known.
void set_motion(TrackRow& row, const dic::RigidMotion& motion, const motion::Stretch& stretch,
                const BallLight& light = {});
// The same of a pair, and with what the circles of both frames state of it where it is `doubted`:
// it may be a turn out of the picture's plane.
void state_motion(TrackRow& row, const TrackRow& next, const motion::PairMotion& pair,
                  const BallLight& light, bool doubted);
// All that a measured pair tells, held against its circles.
void set_pair(TrackRow& row, const TrackRow& next, motion::PairMotion& pair, const BallLight& light,
              bool doubted);
// The turn of a body that is no sphere, and the way from one of its outlines to the next.
void set_round_motion(TrackRow& row, const dic::RigidMotion& motion);
// Where there is no frame to move to.
void forget_motion(TrackRow& row);
// Where the pictures' places in the scene are not known: the row keeps its turn alone.
void forget_way(TrackRow& row);
// A motion that may be a turn out of the picture's plane: it states no less than the circles of
// both frames do of the way between them, and of its turn no less than such a tilt may add.
void doubt_motion(TrackRow& row, const TrackRow& next);
// From the region of interest and the analysed frames to places in the whole picture and frames of
// the clip.
void place_in_clip(TrackRow& row, const Roi& roi, const FrameRange& frames);
// Of the last frame, which shows a circle. That alone may be anything, and so may one to which no
// motion led, or one without a texture: with motions measured, all others stand in two frames that
// follow each other.
TrackStatus status_behind(const TrackRow& before);

}  // namespace impactdic::pipeline
