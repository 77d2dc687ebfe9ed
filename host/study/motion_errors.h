// Measured motions of a ball and its windows against the exact ones.
#pragma once

#include <cmath>

#include "host/dic/error_bound.h"
#include "host/study/study_case.h"

namespace impactdic::study {

// Running sums of one error.
class ErrorSums {
 public:
  void add(double error) {
    ++count_;
    sum_ += error;
    magnitudes_ += std::abs(error);
    squares_ += error * error;
  }
  int count() const { return count_; }
  // NaN where nothing was added.
  double mean() const { return sum_ / count_; }
  double mean_abs() const { return magnitudes_ / count_; }
  double rms() const { return std::sqrt(squares_ / count_); }
  double sd() const { return std::sqrt(std::max(0.0, squares_ / count_ - mean() * mean())); }

 private:
  int count_ = 0;
  double sum_ = 0, magnitudes_ = 0, squares_ = 0;
};

// The errors of one estimator on one clip.
struct MotionErrors {
  int pairs = 0, failed_pairs = 0;
  // Of what `track` would state: the motion of the measured centre against the true centre's.
  ErrorSums dx_px, dy_px, rot_deg;
  // Of the estimator alone, both axes: its motion taken to the true centre.
  ErrorSums shift_px;
  // Both axes, and the bound of the same windows: those found right, whole on the ball, in which
  // there is something to be found (bound up to kUsablePx).
  ErrorSums window_px, window_bound_px;
  // Of all windows: those refused, and those called right although they are wrong.
  int windows = 0, no_texture = 0, failed = 0, wrong = 0;
  double seconds = 0;
};

// Where the ball was in the first frame, and how it moved.
struct PairTruth {
  double cx_px, cy_px;
  StudyMotion motion;
};

// A window whose displacement is further off than this, and yet is called right, is wrong.
inline constexpr double kWrongPx = 0.5;
// A window that noise lets nobody measure better than this has too little texture to count.
inline constexpr double kUsablePx = 0.1;

// Adds one measured pair. `slopes`: of the first frame without noise; `noise`: of the frames.
void add_pair(const motion::PairMotion& pair, const PairTruth& truth, int window_px,
              const dic::PictureSlopes& slopes, double noise, MotionErrors& errors);

}  // namespace impactdic::study
