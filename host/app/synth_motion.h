// The options of `synth` that say how the ball moves, and the poses that they mean.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "sim/speckle/motion.h"

namespace impactdic::app {

struct SynthMotionRequest {
  int frames = 0;  // 0: 20, or as many as the motion file has
  std::string start, velocity = "1,0", file;
  double rotation_deg = 0, compression = 0, compression_axis_deg = 90;
};

void add_motion_options(CLI::App& command, SynthMotionRequest& request);

struct SynthMotion {
  std::vector<BallPose> poses;
  std::size_t bar_frame = 0;  // the frame in which a bar hides the stated share
};

// The poses of all frames. Where nothing says where the ball is, the box around its path is put
// into the middle of the picture. Throws InvalidArgument, FileError, FormatError.
SynthMotion make_motion(const SynthMotionRequest& request, int width, int height);

}  // namespace impactdic::app
