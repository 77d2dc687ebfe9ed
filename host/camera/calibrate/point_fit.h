// A point of a target by least squares of the picture around it, with the target's own pattern, the
// camera's perspective and distortion, and the blur of lens and pixels.
#pragma once

#include <impactdic/camera/calibrate.h>
#include <impactdic/image.h>

#include <optional>

#include "host/camera/calibrate/board.h"
#include "host/camera/calibrate/board_sight.h"

namespace impactdic::camera {

// What the target shows around its points.
class PointPattern {
 public:
  explicit PointPattern(const CalibrateRequest& request);

  bool dot() const { return dot_; }
  bool marked() const { return marker_share_ > 0; }
  double pitch_m() const { return pitch_m_; }
  double dot_radius_m() const { return dot_radius_m_; }
  // From the edges of a square to the marker within it.
  double margin_m() const { return (1 - marker_share_) / 2 * pitch_m_; }
  // How far into its black border a marker is known whatever its bits are.
  double known_border_m() const;
  // 1: white where both axes of the target point the same way from this corner; -1: black.
  double white_sign(std::size_t point) const;

 private:
  bool dot_;
  int columns_;  // of points
  double pitch_m_, dot_radius_m_ = 0, marker_share_ = 0;
};

struct FittedPoint {
  Eigen::Vector2d at_px;       // where the target's point is seen
  Eigen::Matrix2d covariance;  // of it, px², from the scatter of the grey levels about the fit
  double blur_px = 0;          // Gaussian deviation, without the pixels' own extent
};

// The target's pattern as `sight` shows it is moved in the picture until it fits, with these
// unknowns: the shift, the blur, black and white, each with a slope along both axes of the picture,
// and the radius of a dot. Pixels nearer to this point than to its neighbours take part, as far as
// they lie near an edge; within markers none but the outermost of their black border.
//
// An edge of light blurred by a Gaussian is the normal distribution function of the distance to it;
// pixels are integrated by two Gauss points along either axis. What is alike on both sides of the
// point (ink that runs, a wrong size of markers, a curve of grey levels) moves it nowhere.
//
// `picture`: grey levels. `seen`: the point as it was found. `board_m`: its place on the target.
// Nothing where too little is seen, or where the fit does not settle near `seen`.
std::optional<FittedPoint> fit_point(const Image<float>& picture, const BoardSight& sight,
                                     const PointPattern& pattern, const Sighting& seen,
                                     const Eigen::Vector2d& board_m);

}  // namespace impactdic::camera
