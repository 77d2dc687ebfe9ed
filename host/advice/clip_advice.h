// A quick look at a clip before a long run: its texture, and what a person will want to know of it
// before it is measured.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/advice/texture_advice.h"
#include "host/circle/scout_ball.h"
#include "host/clip/frame_range.h"
#include "host/motion/motion_estimator.h"
#include "host/video/frame_source.h"

namespace impactdic::advice {

struct AdviceRequest {
  FrameRange frames;
  Roi roi;
  bool ball = true;  // look for a ball; otherwise the rectangle is the surface
  circle::CircleOptions circle;
  // Of scout_ball: what has another radius, or stands still, is not the ball.
  std::optional<double> radius_px;
  std::shared_ptr<const circle::StillScene> scene;
  std::shared_ptr<const circle::Backdrop> backdrop;  // what lies behind the ball, where it is known
  // Frames in which the ball is known already, to about a pixel: there it is not searched for.
  std::vector<circle::BallCandidate::Sighting> sightings;
  // The same of frames that are looked at only where the usual ones show no ball twice.
  std::vector<circle::BallCandidate::Sighting> spare_sightings;
  std::shared_ptr<const circle::BallChoice> choice;  // nor is a ball that was not chosen
  Estimator estimator = Estimator::kField;
  FieldOptions field;
  bool with_field = true;  // windows will be measured
  double rim_margin_px = 3;
};

// The ball's outline with the deviation of its centre about each axis, px.
struct FoundBall : Circle {
  double centre_sd_px = 0;
  double oval = 0;  // of an ellipse R ± e: e / R
};

// Neighbouring frames, cut to the region of interest, and the ball in both.
struct BallPair {
  std::int64_t index = 0;  // of the first among the analysed frames
  Frame first, second;
  FoundBall first_ball, second_ball;
};

// One frame, cut to the region of interest, and the ball in it.
struct BallPicture {
  Frame picture;
  FoundBall ball;
};
// The frame `index` among the analysed ones, cut likewise; nullopt where it cannot be read.
std::optional<Frame> read_picture(FrameSource& source, const AdviceRequest& request,
                                  std::int64_t index);
// The ball in that frame, within some pixels of `guess`; nullopt where it is not there.
std::optional<FoundBall> look_near(FrameSource& source, const AdviceRequest& request,
                                   std::int64_t index, const Circle& guess);
// Of the frame `index` among the analysed ones, the ball looked for near `near` first; nullopt
// where there is none or the frame cannot be read.
std::optional<BallPicture> look_for_ball(FrameSource& source, const AdviceRequest& request,
                                         std::int64_t index, const Circle& near);
// The last frame that advice reads, so that a container need not be decoded to its end.
std::int64_t last_looked_at(FrameSource& source, const FrameRange& frames);

// Whether the picture has texture from side to side, where a ball has a background.
bool is_texture_alone(const Frame& frame, const FieldOptions& field);

// What to paint where there is too little texture, after the finding of the speckle study
// (docs/accuracy/patterns.md).
extern const char* const kBetterPattern;

// Looks at three pairs of neighbouring frames: at the start, in the middle and at the end of the
// range (of its first 48 frames in a container, which may have to be decoded in order). A frame
// that cannot be read is left out: the run itself will say so. `pairs`, where given, gets those
// that show the ball twice.
ClipAdvice advise_clip(FrameSource& source, const AdviceRequest& request,
                       std::vector<BallPair>* pairs = nullptr);

}  // namespace impactdic::advice
