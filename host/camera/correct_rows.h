// Rows of a track as a camera without distortion that looks squarely at the plane of motion would
// have them.
#pragma once

#include <impactdic/track.h>

#include <vector>

#include "host/camera/ball_view.h"

namespace impactdic::camera {

class RowCorrection {
 public:
  // `metre_per_px`: of the corrected rows, whatever the camera. `sphere`: a ball that was measured
  // as one in the camera's perspective, whose motions are those of its centre; a camera whose focal
  // length is not known shows it as a disc. `rim_margin_px`: how far inside the rim the texture was
  // registered.
  RowCorrection(const Camera& camera, bool sphere, double metre_per_px, double rim_margin_px);

  // Circle, motion and pose; deviations by the local slope. Corrected pixels are `metre_per_px`
  // wide, y down, with (0, height - 1) at the origin of the world axes: to_si with that scale gives
  // world axes. What cannot be corrected is NaN, and the row then has no circle or no motion.
  std::vector<TrackRow> correct(const std::vector<TrackRow>& rows) const;

 private:
  void correct_circle(const BallInPlane& ball, TrackRow& row) const;
  void correct_motion(const TrackRow& seen, const BallInPlane& ball, TrackRow& row) const;
  void correct_pose(const std::vector<TrackRow>& seen, TrackRow& row) const;
  // What moved as a row's motion says: the middle of a disc, the picture of a sphere's centre.
  CircleInPicture followed(const TrackRow& row, const BallInPlane& ball) const;
  Eigen::Vector2d to_corrected(const Eigen::Vector2d& world) const;

  PlaneView plane_;
  bool sphere_;
  BallView ball_;
  double metre_per_px_;
  int height_;
};

}  // namespace impactdic::camera
