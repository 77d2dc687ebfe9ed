// How the ball moved between two frames: one interface, one estimator per method behind it.
#pragma once

#include <impactdic/image.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host/clip/track_row.h"
#include "host/dic/field.h"
#include "host/motion/ball_shape.h"
#include "host/motion/field_motion.h"
#include "host/motion/perspective.h"
#include "host/sphere/picture_blur.h"

namespace impactdic::dic {
class DeviceFrames;
}  // namespace impactdic::dic
namespace impactdic::opencl {
class Engine;
}  // namespace impactdic::opencl

namespace impactdic::motion {

struct EstimatorOptions {
  Estimator estimator = Estimator::kField;
  FieldOptions field;
  int spacing_px = 0;        // of the windows' grid; 0: half a window, rounded up
  double rim_margin_px = 3;  // windows keep this far inside the rim
  int fewest_windows = 3;    // that may carry a motion
  bool sphere = false;       // the ball turns about any axis (kBall alone), else in the picture
  // Of a ball taken for flat: the turn out of the picture's plane, rad a frame, that it may have
  // all the same (unseen_tilt.h).
  double unseen_tilt_rad = 0;
  double sphere_radius_px = 0;  // of its surface; 0: as its rim
  double sphere_radius_sd_px = 0.5;
  double sphere_blur_px2 = sphere::kUsualBlur_px2;  // of its pictures, see BallTask
  BallLight sphere_light{};  // on it, the same in all pictures; all 0 where it is not known
  // Of the pictures: 0 where something that stands still before the ball, or on it, shows; nullptr:
  // nowhere.
  std::shared_ptr<const Image<std::uint8_t>> moving;
  bool is_lit() const { return sphere && sphere_light.least > 0; }
  Perspective perspective;  // of the sphere; its pairs' circles are about its centre
  // Of the sphere, where its rim has this radius.
  double sphere_radius(double rim_px) const {
    return sphere_radius_px > 0 ? sphere_radius_px : rim_px;
  }
  int effective_spacing_px() const {
    return spacing_px > 0 ? spacing_px : (field.window_px + 1) / 2;
  }
  void validate() const;  // throws InvalidArgument
};

// One pair of frames: what is known before, and what comes out.
struct PairMotion {
  int first_slot = 0, second_slot = 0;
  Circle first, second;  // the ball in both frames
  BallShape shape, second_shape;
  // An outline of it, or of the frames beside it, is an ellipse, or none was found.
  bool near_contact = false;
  // Pixel (0, 0) of the parts of the frames in which the circles are.
  int first_left_px = 0, first_top_px = 0, second_left_px = 0, second_top_px = 0;
  // Of a pair before this one; a sphere's is the rotation vector (x, y, and this).
  double guess_rot_rad = 0;
  double guess_rot_x_rad = 0, guess_rot_y_rad = 0;
  // Results.
  TrackStatus status = TrackStatus::kLowCorrelation;
  dic::RigidMotion motion;  // of the ball's centre in the first frame
  bool sought = false;      // its turn was looked for everywhere, or from one that was
  Stretch stretch;          // of the ball's picture, as it was registered
  CentreMotion centre;      // the field interpolated there
  FieldStrain strain;       // of the ball's picture from frame to frame; asked for by `ball` alone
  std::vector<Window> windows;
  std::vector<WindowMotion> field;
};

class MotionEstimator {
 public:
  virtual ~MotionEstimator() = default;
  // Measures every pair of the frames that the estimator was made with; a pair that cannot be
  // measured has a status. Pairs may name any slots: consecutive frames, or a frame and a keyframe
  // that was left in its slot.
  virtual void measure(std::span<PairMotion> pairs) = 0;
  // The aiming pass: the motions well enough to aim other pairs' windows by them, at the least
  // cost.
  virtual void aim(std::span<PairMotion> pairs) { measure(pairs); }
  // Centres of the windows relative to the ball's centre rounded to whole pixels: fixed for the
  // whole clip, so that window i of every frame is the same place on the ball. Empty where the
  // estimator has no windows.
  virtual std::span<const Window> grid() const = 0;
  // How long the host's part, the fits, took so far.
  virtual double fit_seconds() const { return 0; }
};

// `radius_px` is the ball's. `frames` is shared by whoever measures on them: its owner puts the
// pictures in. It and `engine` must outlive the estimator.
std::unique_ptr<MotionEstimator> make_motion_estimator(opencl::Engine& engine,
                                                       const EstimatorOptions& options,
                                                       double radius_px, dic::DeviceFrames& frames);

}  // namespace impactdic::motion
