// The options of `synth` that say how the ball moves, and the poses that they mean.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "sim/speckle/motion.h"

namespace impactdic::app {

struct SynthMotionRequest {
  int frames = 0;  // 0: 20; as many as the motion file has; 110 of an impact
  std::string start, velocity = "1,0", file, impact_job;
  double rotation_deg = 0, compression = 0, compression_axis_deg = 90;
  double touch_frame = 25;  // of an impact
};

void add_motion_options(CLI::App& command, SynthMotionRequest& request);

struct SynthMotion {
  std::vector<sim::speckle::BallPose> poses;
  std::size_t bar_frame = 0;     // the frame in which a bar hides the stated share
  double surface_angle_deg = 0;  // the bar's direction
};

// The poses of all frames. Where nothing says where the ball is, the box around its path is put
// into the middle of the picture. Throws InvalidArgument, FileError, FormatError.
SynthMotion make_motion(const SynthMotionRequest& request, int width, int height, double fps,
                        double radius_px);

}  // namespace impactdic::app
