#include "host/app/synth_motion.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "host/base/parse.h"
#include "sim/contact/motion.h"
#include "sim/job/job_toml.h"

namespace impactdic::app {
namespace {

constexpr int kDefaultFrames = 20;
constexpr int kImpactFrames = 110;

// Puts a path that is known only relative to its first frame into the picture.
void put_into_picture(std::vector<sim::speckle::BallPose>& poses, const std::string& start,
                      int width, int height) {
  double x, y;
  if (!start.empty()) {
    const std::vector<double> at = parse_doubles(start, ',', 2, "--start-px");
    x = at[0] - poses.front().cx_px;
    y = at[1] - poses.front().cy_px;
  } else {
    const auto [left, right] =
        std::minmax_element(poses.begin(), poses.end(),
                            [](const sim::speckle::BallPose& a, const sim::speckle::BallPose& b) {
                              return a.cx_px < b.cx_px;
                            });
    const auto [top, bottom] =
        std::minmax_element(poses.begin(), poses.end(),
                            [](const sim::speckle::BallPose& a, const sim::speckle::BallPose& b) {
                              return a.cy_px < b.cy_px;
                            });
    x = (width - 1) / 2.0 - (left->cx_px + right->cx_px) / 2;
    y = (height - 1) / 2.0 - (top->cy_px + bottom->cy_px) / 2;
  }
  for (sim::speckle::BallPose& pose : poses) {
    pose.cx_px += x;
    pose.cy_px += y;
  }
}

std::vector<sim::speckle::BallPose> constant_poses(const SynthMotionRequest& request) {
  const std::vector<double> step = parse_doubles(request.velocity, ',', 2, "--velocity-px");
  sim::speckle::ConstantMotion motion;
  motion.dx_px = step[0];
  motion.dy_px = step[1];
  motion.rotation_deg = request.rotation_deg;
  motion.compression_per_frame = request.compression;
  motion.start.compression_axis_deg = request.compression_axis_deg;
  return sim::speckle::constant_motion(motion,
                                       request.frames > 0 ? request.frames : kDefaultFrames);
}

// A file or a model says how the ball moves; options that say otherwise would be lost silently.
void refuse_constant_motion(const SynthMotionRequest& request, const std::string& source) {
  const SynthMotionRequest usual;
  if (request.velocity != usual.velocity || request.rotation_deg != 0 || request.compression != 0) {
    throw InvalidArgument("the motion is given twice", source,
                          "leave out --velocity-px, --rotation-deg and --compression");
  }
}

void cut_to(int frames, const std::string& file, std::vector<sim::speckle::BallPose>& poses) {
  if (frames == 0) return;
  if (static_cast<std::size_t>(frames) > poses.size()) {
    throw InvalidArgument("the motion has only " + std::to_string(poses.size()) + " frames", file,
                          "ask for fewer with --frames");
  }
  poses.resize(static_cast<std::size_t>(frames));
}

// The path of an impact, relative to the first touch, which the radius in px scales.
SynthMotion impact_motion(const SynthMotionRequest& request, double fps, double radius_px) {
  const sim::contact::ImpactJob job = sim::job::read_simulate_job(request.impact_job).impact;
  if (job.body.shape == sim::contact::Shape::kRod) {
    throw InvalidArgument("the renderer knows balls only", request.impact_job, "not a rod");
  }
  const int frames = request.frames > 0 ? request.frames : kImpactFrames;
  const double px_per_m = 2 * radius_px / job.body.diameter_m;
  SynthMotion motion;
  motion.surface_angle_deg = job.surface_angle_deg;
  motion.bar_frame =
      static_cast<std::size_t>(std::clamp(std::lround(request.touch_frame), 0L, frames - 1L));
  for (const sim::contact::FramePose& at :
       sim::contact::simulate_motion(job, fps, frames, request.touch_frame)) {
    motion.poses.push_back({at.x_m * px_per_m, -at.y_m * px_per_m, at.angle_rad * kDegPerRad,
                            at.compression, job.surface_angle_deg + 90});
  }
  return motion;
}

// A path that is the same wherever the program runs.
std::string absolute_path(std::string path) { return std::filesystem::absolute(path).string(); }

}  // namespace

void add_motion_options(CLI::App& command, SynthMotionRequest& request) {
  command
      .add_option("--frames", request.frames,
                  "How many frames; 0: 20, as many as the motion file has, 110 of an impact")
      ->check(CLI::Range(0, 10000000))
      ->capture_default_str();
  command
      .add_option("--velocity-px", request.velocity,
                  "DX,DY: the centre's motion per frame, x right, y down, px")
      ->capture_default_str();
  command
      .add_option("--rotation-deg", request.rotation_deg,
                  "Rotation per frame, counter-clockwise on the screen")
      ->capture_default_str();
  command
      .add_option("--compression", request.compression,
                  "Share of its diameter by which the ball gets shorter per frame")
      ->check(CLI::Range(0.0, 0.5))
      ->capture_default_str();
  command
      .add_option("--compression-axis-deg", request.compression_axis_deg,
                  "Axis of the compression, counter-clockwise from image-right")
      ->capture_default_str();
  command.add_option(
      "--start-px", request.start,
      "X,Y: the centre in frame 0; without it the path lies in the picture's middle");
  command
      .add_option("--motion", request.file,
                  "CSV with a row per frame: cx_px,cy_px or dx_px,dy_px, angle_deg or rot_deg, "
                  "compression, compression_axis_deg; a truth.csv is such a file")
      ->transform(absolute_path);
  command
      .add_option("--simulate", request.impact_job,
                  "Job of impactdic simulate: the ball follows the integrated impact, compressed "
                  "along the surface's normal; its diameter is twice --radius-px")
      ->transform(absolute_path);
  command
      .add_option("--touch-frame", request.touch_frame,
                  "With --simulate: the frame, fractions allowed, of the first touch")
      ->capture_default_str();
}

SynthMotion make_motion(const SynthMotionRequest& request, int width, int height, double fps,
                        double radius_px) {
  SynthMotion motion;
  bool placed = false;
  if (!request.file.empty() && !request.impact_job.empty()) {
    throw InvalidArgument("the motion is given twice", "--motion, --simulate", "choose one");
  }
  if (!request.impact_job.empty()) {
    refuse_constant_motion(request, "--simulate");
    motion = impact_motion(request, fps, radius_px);
  } else if (!request.file.empty()) {
    refuse_constant_motion(request, "--motion");
    sim::speckle::MotionTable table = sim::speckle::read_motion_csv(request.file);
    motion.poses = std::move(table.poses);
    placed = table.placed;
    cut_to(request.frames, request.file, motion.poses);
    motion.bar_frame = (motion.poses.size() - 1) / 2;
  } else {
    motion.poses = constant_poses(request);
    motion.bar_frame = (motion.poses.size() - 1) / 2;
  }
  if (placed && !request.start.empty()) {
    throw InvalidArgument("the motion file already says where the ball is", "--start-px",
                          "leave it out, or give dx_px,dy_px in the file");
  }
  if (!placed) put_into_picture(motion.poses, request.start, width, height);
  return motion;
}

}  // namespace impactdic::app
