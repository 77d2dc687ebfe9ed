// Where the ball is in every frame: the truth of a rendered clip.
#pragma once

#include <impactdic/synth.h>

#include <filesystem>
#include <span>
#include <vector>

namespace impactdic::sim::speckle {

// The ball while the shutter is open: it moves straight from `open` to `middle` to `close`.
struct ShutterPath {
  BallPose open, middle, close;
};

// Poses of `frames` frames; frame k is the start plus k steps (no sum accumulates).
std::vector<BallPose> constant_motion(const ConstantMotion& motion, int frames);

// Reads poses from CSV with a header. Columns known: cx_px and cy_px, or dx_px and dy_px (each row
// the motion to the next one; summed); angle_deg, or rot_deg (summed likewise); compression;
// compression_axis_deg (90 where absent). Others (frame, time_s, r_px) are ignored, so a truth.csv
// is such a file. Throws FileError, or FormatError naming the line.
GivenMotion read_motion_csv(const std::filesystem::path& file);

// Writes exactly frame,time_s,cx_px,cy_px,r_px,dx_px,dy_px,rot_deg: row k's motion is from frame k
// to k + 1, dx and dy at the ball's centre; the last row's motion is empty. Numbers read back as
// the same doubles. r_px is the radius of the ball when it is not compressed. Throws FileError.
void write_truth_csv(const std::filesystem::path& file, std::span<const BallPose> poses,
                     double radius_px, double fps);

// Writes frame,compression,compression_axis_deg, the truth that truth.csv has no columns for.
void write_compression_csv(const std::filesystem::path& file, std::span<const BallPose> poses);

// The ball while frame `index` is exposed: the shutter is open for `exposure` (0 … 1) of the frame
// interval, its middle at the frame's own time, so that the truth is the pose at mid-exposure.
// Before the first frame and after the last the motion goes on as it was.
ShutterPath shutter_path(std::span<const BallPose> poses, std::size_t index, double exposure);

}  // namespace impactdic::sim::speckle
