// Where the ball is in every frame: the truth of a rendered clip.
#pragma once

#include <impactdic/synth.h>

#include <filesystem>
#include <span>
#include <utility>
#include <vector>

namespace impactdic::sim::speckle {

// The ball while the shutter is open: it moves straight from `open` to `middle` to `close`.
struct ShutterPath {
  BallPose open, middle, close;
};

// Poses of `frames` frames; frame k is the start plus k steps (no sum accumulates).
std::vector<BallPose> constant_motion(const ConstantMotion& motion, int frames);

// Reads poses from CSV with a header. Columns known: cx_px and cy_px (or x_px and y_px), or dx_px
// and dy_px (each row the motion to the next one; summed); angle_deg (or rz_deg), or rot_deg
// (summed likewise); rx_deg and ry_deg of a rotation vector whose third component is rz_deg; z_px;
// compression; compression_axis_deg (90 where absent). Others (frame, time_s, r_px) are ignored, so
// a truth.csv is such a file. Throws FileError, or FormatError naming the line.
GivenMotion read_motion_csv(const std::filesystem::path& file);

// Writes exactly frame,time_s,cx_px,cy_px,r_px,dx_px,dy_px,rot_deg: row k's motion is from frame k
// to k + 1, dx and dy at the ball's centre; the last row's motion is empty. Numbers read back as
// the same doubles. r_px is the radius of the ball when it is not compressed. Throws FileError.
void write_truth_csv(const std::filesystem::path& file, std::span<const BallPose> poses,
                     double radius_px, double fps);

// The same of a sphere, and behind those columns
// z_px,rx_deg,ry_deg,rz_deg,qw,qx,qy,qz,rot_x_deg,rot_y_deg. rx, ry, rz is the rotation vector of
// the orientation, q the same as a unit quaternion (ball axes to camera axes, qw >= 0); rot_x_deg,
// rot_y_deg and rot_deg are the rotation vector of the turn from frame k to k + 1. All in camera
// axes. r_px is the radius in the picture, times the scale at the centre's depth.
void write_sphere_truth_csv(const std::filesystem::path& file, std::span<const BallPose> poses,
                            double radius_px, double distance_radii, double fps);

// The ball's radius in the picture's px at the depth of its centre.
double radius_seen(const BallPose& pose, double radius_px, double distance_radii);

// Writes frame,compression,compression_axis_deg, the truth that truth.csv has no columns for.
void write_compression_csv(const std::filesystem::path& file, std::span<const BallPose> poses);

// The ball while frame `index` is exposed: the shutter is open for `exposure` (0 … 1) of the frame
// interval, its middle at the frame's own time, so that the truth is the pose at mid-exposure.
// Before the first frame and after the last the motion goes on as it was.
ShutterPath shutter_path(std::span<const BallPose> poses, std::size_t index, double exposure);

// Instants and their weights (sum 1) that stand for the exposure: as many that a point of the ball
// moves less than a pixel between two of them. `px_per_z`: how far a point moves in the picture, at
// most, when the ball comes nearer by 1 px.
std::vector<std::pair<BallPose, double>> instants_of(const ShutterPath& path, double radius_px,
                                                     double px_per_z = 0);

}  // namespace impactdic::sim::speckle
