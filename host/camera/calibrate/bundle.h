// The adjustment of a camera and of the poses of a flat target to the points that pictures show
// (Zhang 2000, section 3.2): weighted least squares in all parameters at once.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "host/camera/calibrate/board.h"

namespace impactdic::camera {

inline constexpr int kLensValues = 9;  // fx, fy, cx, cy, k1, k2, p1, p2, k3
inline constexpr int kPoseValues = 6;  // turn (rad), position (m)
using LensValues = Eigen::Matrix<double, kLensValues, 1>;
using Pose = Eigen::Matrix<double, kPoseValues, 1>;

// Which parameters of the lens are free; the others of its distortion are zero. Focal length and
// principal point always are.
struct LensTerms {
  int radial = 0;  // how many of k1, k2, k3
  bool decentred = false;
  bool aspect = false;  // fx and fy apart: pixels that are not square
  int count() const { return 3 + radial + (decentred ? 2 : 0) + (aspect ? 1 : 0); }
};

struct Adjusted {
  LensTerms terms;
  LensValues lens = LensValues::Zero();
  std::vector<Pose> poses;  // one a view
  // Sum of squared residuals, each over its deviation.
  double chi_square = 0;
};

// Which points take part, [view][sighting], and each view's scatter beyond what the points' own
// covariances say (a target that is not quite flat, a printer that is not quite even), px.
struct Weights {
  std::vector<double> sd_px;
  std::vector<std::vector<char>> used;
  std::size_t points() const;
};

// The root of the inverse of a point's covariance when it scatters by `sd_px` beyond it: takes a
// residual to one whose parts are independent and have a deviation of 1.
Eigen::Matrix2d whitening(const Sighting& sighting, double sd_px);

class Bundle {
 public:
  Bundle(BoardPoints board, std::vector<View> views, int width, int height);

  const std::vector<View>& views() const { return views_; }
  const BoardPoints& board() const { return board_; }
  void move_sighting(std::size_t view, std::size_t sighting, const Eigen::Vector2d& at_px) {
    views_[view].seen[sighting].at_px = at_px;
  }
  // All points alike, to a pixel, but for those that lie by three tenths of a pitch or more beside
  // the plane map (homography) that most of their view's points follow: squares taken for others.
  Weights first_weights() const;

  // A start: the focal length at which the views' poses fit best, no distortion. Throws
  // InvalidArgument where a view has fewer than four points.
  Adjusted guess(const Weights& weights) const;

  // From a start to the minimum (Levenberg 1944, Marquardt 1963).
  Adjusted adjust(const LensTerms& terms, Adjusted start, const Weights& weights) const;

  // For each view, whether the target is turned the other way (Collins and Bartoli 2014: a plane
  // seen from afar has two poses that fit about as well). True where one was changed.
  bool turn_over(Adjusted& state, const Weights& weights) const;

  // Of lens and one view's pose together, (15, 15), from the normal equations.
  Eigen::MatrixXd covariance(const Adjusted& state, const Weights& weights, std::size_t view) const;

  // Residuals of a view, px; those that do not take part too.
  std::vector<Eigen::Vector2d> residuals(const Adjusted& state, std::size_t view) const;

 private:
  struct Normal;
  Normal normal_equations(const Adjusted& state, const Weights& weights) const;
  double add_prior(const Adjusted& state, Normal* normal) const;
  double chi_square(const Adjusted& state, const Weights& weights) const;
  std::vector<Pose> poses_of(std::size_t view, const LensValues& lens,
                             const Weights& weights) const;

  BoardPoints board_;
  std::vector<View> views_;
  int width_, height_;
};

}  // namespace impactdic::camera
