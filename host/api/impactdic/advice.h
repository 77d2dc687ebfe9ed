// A quick look at a clip before a long run: what its texture lets be measured, and what a person
// will want to know of it before it is.
#pragma once

#include <impactdic/camera/model.h>
#include <impactdic/circle.h>
#include <impactdic/clip.h>
#include <impactdic/export.h>
#include <impactdic/field.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace IMPACTDIC_PUBLIC impactdic {

// The Cramér–Rao bound of a whole ball's motion between two pictures: one standard deviation.
struct BallBound {
  double dx_sd_px = 0, dy_sd_px = 0, rot_sd_rad = 0;
};

// Windows of one size, over the surface that was looked at.
struct SizeAdvice {
  int window_px = 0;
  int windows = 0, usable = 0;
  double error_px = 0;  // median over the usable ones, per axis; NaN where there is none
  double contrast = 0;  // median over all, rms, grey levels of 255
  double usable_share() const { return windows > 0 ? static_cast<double>(usable) / windows : 0; }
};

struct TextureAdvice {
  double noise = 0;               // standard deviation, grey levels of 255
  SizeAdvice asked;               // the window size asked for
  std::vector<SizeAdvice> sizes;  // others, ascending
  std::optional<BallBound> ball;  // of the ball as a whole
};

struct ClipAdvice {
  int frames = 0, frames_with_ball = 0;  // of those looked at
  std::optional<Circle> ball;            // in whole-picture pixels, in the frame judged
  std::optional<TextureAdvice> texture;  // nullopt where there was no ball to judge
  std::optional<double> edge_px;         // how sharp the ball's edge is, 10 to 90 %
  std::optional<double> turn_deg;        // largest seen, per frame
  // The ball's only texture is a spot that stays at one place of its disc in frames spread over the
  // clip, as a lamp's reflex does: it tells nothing of the spin.
  bool reflex_alone = false;
  std::vector<std::string> warnings;  // one useful sentence each
};

// The smallest window by which at least nine in ten are usable and err by at most `error_px`; 0
// where none does.
int window_reaching(const TextureAdvice& advice, double error_px);

// A thing in the picture that may be the ball, as some frames spread over the clip show it.
struct BallSeen {
  double radius_px = 0;     // median
  double rim_fraction = 0;  // mean share of its rim that is seen, 0 … 1
  double moved_px = 0;      // between the two places farthest apart
  int frames = 0;           // that show it, of those looked at
  // Where the most of its rim is seen: px of the whole picture, in this frame of the stored file.
  Circle place;
  std::int64_t frame = 0;
};

struct InspectRequest {
  ClipRequest clip;
  FieldOptions field;  // window size and thresholds that the texture is judged by
  // Looks through all of the clip for what may be the ball, as `track` does before it measures.
  bool candidates = false;
  std::string camera;     // that `calibrate` wrote; "": none
  void validate() const;  // throws InvalidArgument
};

// What the command `info` says of a clip.
struct Inspection {
  ClipInfo clip;
  std::optional<double> last_frame_time_s;  // by the camera's own clock, since frame 0
  std::optional<PlaneFigures> camera;       // where one was given
  // The ball's texture; that of the whole picture where there is no ball.
  ClipAdvice advice;
  // Where it was asked for: the best first, of so many frames looked at. TrackRequest::ball counts
  // them from 1.
  std::vector<BallSeen> candidates;
  int candidate_frames = 0;
  // Of the file's header (its doubtful frame rate not where the request gives one), then of the
  // look.
  std::vector<std::string> warnings;
};

// Needs no device. Throws InvalidArgument, FileError, FormatError.
Inspection inspect(const InspectRequest& request);

}  // namespace impactdic
