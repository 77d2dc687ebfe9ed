// Measured motions of a ball and its windows against the exact ones.
#pragma once

#include "host/dic/error_bound.h"
#include "host/study/study_case.h"

namespace impactdic::study {

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
