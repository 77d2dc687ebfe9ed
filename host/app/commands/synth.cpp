#include <impactdic/error.h>
#include <impactdic/synth.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "host/app/command.h"
#include "host/app/job.h"
#include "host/app/run_context.h"
#include "host/app/terminal_progress.h"
#include "host/base/parse.h"
#include "host/run/synth_files.h"
#include "sim/job/job_toml.h"
#include "sim/speckle/motion.h"

namespace impactdic::app {
namespace {

constexpr const char* kUsualVelocity = "1,0";

struct Options {
  Common common;
  SynthRequest synth;
  ConstantMotion step;
  std::string output, body = "disc", size = "512x512", format = "tiff";
  std::vector<double> distortion;
  std::string start, velocity = kUsualVelocity, spin, motion_file, impact_job;
  double touch_frame = 25;  // of an impact
};

void parse_size(const std::string& text, SynthScene& scene) {
  const std::vector<double> sides = parse_doubles(text, 'x', 2, "--size");
  for (const double side : sides) {
    if (!(side >= 1 && side <= 32768 && side == std::floor(side))) {
      throw InvalidArgument("the size '" + text + "' is impossible", "--size",
                            "WIDTHxHEIGHT, whole pixels up to 32768");
    }
  }
  scene.width = static_cast<int>(sides[0]);
  scene.height = static_cast<int>(sides[1]);
}

// A file or a model says how the ball moves; options that say otherwise would be lost silently.
void refuse_constant_motion(const Options& options, const std::string& source) {
  if (options.velocity != kUsualVelocity || options.step.rotation_deg != 0 ||
      !options.spin.empty() || options.step.compression_per_frame != 0) {
    throw InvalidArgument("the motion is given twice", source,
                          "leave out --velocity-px, --rotation-deg, --spin-deg and --compression");
  }
}

ConstantMotion constant_motion(const Options& options) {
  ConstantMotion motion = options.step;
  const std::vector<double> step = parse_doubles(options.velocity, ',', 0, "--velocity-px");
  if (step.size() != 2 && step.size() != 3) {
    throw InvalidArgument("'" + options.velocity + "' is no velocity", "--velocity-px",
                          "DX,DY or DX,DY,DZ");
  }
  motion.dx_px = step[0];
  motion.dy_px = step[1];
  if (step.size() == 3) motion.dz_px = step[2];
  if (options.spin.empty()) return motion;
  if (motion.rotation_deg != 0) {
    throw InvalidArgument("the rotation is given twice", "--rotation-deg, --spin-deg",
                          "choose one");
  }
  const std::vector<double> spin = parse_doubles(options.spin, ',', 0, "--spin-deg");
  if (spin.size() != 1 && spin.size() != 3) {
    throw InvalidArgument("'" + options.spin + "' is no spin", "--spin-deg", "X,Y,Z or Z");
  }
  motion.rotation_deg = spin.back();
  if (spin.size() == 3) {
    motion.spin_x_deg = spin[0];
    motion.spin_y_deg = spin[1];
  }
  return motion;
}

void read_motion(const Options& options, SynthRequest& request) {
  if (!options.motion_file.empty() && !options.impact_job.empty()) {
    throw InvalidArgument("the motion is given twice", "--motion, --simulate", "choose one");
  }
  if (!options.impact_job.empty()) {
    refuse_constant_motion(options, "--simulate");
    request.motion = SimulatedMotion{sim::job::read_simulate_job(options.impact_job).impact,
                                     options.touch_frame};
  } else if (!options.motion_file.empty()) {
    refuse_constant_motion(options, "--motion");
    request.motion = sim::speckle::read_motion_csv(options.motion_file);
  } else {
    request.motion = constant_motion(options);
  }
  if (!options.start.empty()) {
    const std::vector<double> at = parse_doubles(options.start, ',', 2, "--start-px");
    request.start = StartPx{at[0], at[1]};
  }
}

SynthResult render(const SynthRequest& request, video::FrameSink& sink, bool quiet) {
  TerminalProgress progress("synth", quiet);
  RunControl control;
  control.progress = [&](const Progress& p) { progress(p.done, p.total); };
  return synthesize(
      request, [&](const Frame& frame) { sink.write(frame); }, control);
}

void run_synth(const CLI::App& command, const Options& options) {
  const video::SinkFormat format = video::parse_sink_format(options.format);
  SynthRequest request = options.synth;
  if (!options.distortion.empty()) request.scene.distortion_k1 = options.distortion.front();
  if (options.distortion.size() > 1) request.scene.distortion_k2 = options.distortion.back();
  if (options.body == "sphere") request.body = SynthBody::kSphere;
  parse_size(options.size, request.scene);
  read_motion(options, request);
  const RunContext context(options.common, false);
  const SynthTruth truth = synth_truth(request);
  const auto folder = prepare_output_directory(options.output, options.common.force);
  const auto sink = run::open_synth_clip(folder, format, request, truth.poses.size());
  write_job(command, folder / "job.toml");
  // The truth stands beside the clip before the clip is rendered.
  run::write_synth_truth(folder, truth, request);
  const bool quiet = options.common.quiet;
  if (truth.leaves_view && !quiet) {
    std::fprintf(stderr, "impactdic: warning: the ball reaches out of the picture in frame %zu\n",
                 *truth.leaves_view);
  }
  const Stopwatch watch;
  const SynthResult result = render(request, *sink, quiet);
  sink->finish();
  if (!quiet) {
    std::printf("%zu frames, %.1f frames/s; clip and truth in %s\n", result.frames,
                static_cast<double>(result.frames) / watch.seconds(), folder.string().c_str());
  }
}

// A path that is the same wherever the program runs.
std::string absolute_path(std::string path) { return std::filesystem::absolute(path).string(); }

void add_motion_options(CLI::App& command, Options& options) {
  command
      .add_option("--frames", options.synth.frames,
                  "How many frames; 0: 20, as many as the motion file has, 110 of an impact")
      ->check(CLI::Range(0, 10000000))
      ->capture_default_str();
  command
      .add_option("--velocity-px", options.velocity,
                  "DX,DY: the centre's motion per frame, x right, y down, px; a sphere's third "
                  "number is its motion towards the camera")
      ->capture_default_str();
  command
      .add_option("--rotation-deg", options.step.rotation_deg,
                  "Rotation per frame, counter-clockwise on the screen")
      ->capture_default_str();
  command.add_option(
      "--spin-deg", options.spin,
      "X,Y,Z: a sphere's spin vector per frame, X right, Y up, Z towards the camera; "
      "one number is Z, as --rotation-deg");
  command
      .add_option("--compression", options.step.compression_per_frame,
                  "Share of its diameter by which the ball gets shorter per frame")
      ->check(CLI::Range(0.0, 0.5))
      ->capture_default_str();
  command
      .add_option("--compression-axis-deg", options.step.start.compression_axis_deg,
                  "Axis of the compression, counter-clockwise from image-right")
      ->capture_default_str();
  command.add_option(
      "--start-px", options.start,
      "X,Y: the centre in frame 0; without it the path lies in the picture's middle");
  command
      .add_option(
          "--motion,--poses", options.motion_file,
          "CSV with a row per frame: cx_px,cy_px (or x_px,y_px) or dx_px,dy_px, angle_deg or "
          "rot_deg or a sphere's rotation vector rx_deg,ry_deg,rz_deg, z_px, compression, "
          "compression_axis_deg; a truth.csv is such a file")
      ->transform(absolute_path);
  command
      .add_option("--simulate", options.impact_job,
                  "Job of impactdic simulate: the ball follows the integrated impact, compressed "
                  "along the surface's normal; its diameter is twice --radius-px")
      ->transform(absolute_path);
  command
      .add_option("--touch-frame", options.touch_frame,
                  "With --simulate: the frame, fractions allowed, of the first touch")
      ->capture_default_str();
}

void add_camera_options(CLI::App& command, SynthRequest& request) {
  SynthScene& scene = request.scene;
  const auto number = [&command](const char* name, double& value, const char* help, double low,
                                 double high) {
    command.add_option(name, value, help)->check(CLI::Range(low, high))->capture_default_str();
  };
  number("--noise", scene.noise_sigma, "Camera noise, standard deviation in grey levels of 255", 0,
         255);
  number("--blur", scene.psf_sigma_px, "Lens blur, standard deviation in px", 0.3, 50);
  number("--exposure", request.exposure,
         "Share of the frame interval that the shutter is open; the truth is at its middle", 0, 1);
  number("--shading", scene.shading,
         "How much of the light is lost from the rim at the lamp to the rim opposite", 0, 1);
  number("--lamp-deg", scene.lamp_deg, "Where the lamp is, counter-clockwise from image-right",
         -360, 360);
  number("--lamp", scene.lamp_share,
         "Share of a sphere's light that a distant lamp gives; ambient light gives the rest", 0, 1);
  number("--lamp-elevation-deg", scene.lamp_elevation_deg,
         "Of the lamp, from the picture's plane towards the camera", -90, 90);
  number("--limb-darkening", scene.limb_darkening,
         "How much darker a sphere's rim is than its middle", 0, 1);
  number("--distance", scene.distance_radii,
         "Of the camera from a sphere, in its radii, 1.5 or more; 0: parallel rays", 0, 1e9);
  number("--occlude", request.hidden,
         "Share of the ball hidden by a static bar in the clip's middle frame (with "
         "--simulate: at the first touch)",
         0, 1);
  number("--bar-level", request.bar_level, "Grey level of the bar", 0, 255);
  number("--white", scene.white, "Grey level of the ball", 0, 255);
  number("--ink", scene.ink, "Grey level of the speckles", 0, 255);
  number("--background", scene.background, "Grey level of the background", 0, 255);
  command.add_option("--bits", scene.bits, "Bit depth of the frames")
      ->check(CLI::Range(8, 16))
      ->capture_default_str();
}

void add_options(CLI::App& command, Options& options) {
  SynthRequest& request = options.synth;
  command.add_option("-o,--output", options.output, "Folder for the clip and its truth")
      ->required();
  command
      .add_option("--body", options.body,
                  "What is painted: disc, a flat ball that turns in the picture's plane, or sphere")
      ->check(CLI::IsMember({"disc", "sphere"}))
      ->capture_default_str();
  command
      .add_option("--pattern", request.pattern,
                  "Painted ball: a1 … a3, b1 … b3, c1 … c3, d1 … d3, e1, e2, f1, f2; or none")
      ->capture_default_str();
  command.add_option("--seed", request.seed, "Of the pattern and of the noise")
      ->capture_default_str();
  command.add_option("--size", options.size, "WIDTHxHEIGHT of the picture, px")
      ->capture_default_str();
  command.add_option("--fps", request.fps, "Frames a second")
      ->check(positive_number())
      ->capture_default_str();
  command.add_option("--radius-px", request.radius_px, "The ball's radius, px")
      ->check(CLI::Range(20.0, 2000.0))
      ->capture_default_str();
  add_motion_options(command, options);
  add_camera_options(command, request);
  command
      .add_option(
          "--distortion", options.distortion,
          "K1[,K2]: a lens that shows the corners 1 + K1 + K2 times as far from the middle; "
          "the truth is without it")
      ->delimiter(',')
      ->expected(1, 2);
  command
      .add_option("--format", options.format,
                  "tiff, png, avi, cine, mraw, raw; also cine10, cine12, mraw12 (packed) and mp4")
      ->capture_default_str();
  add_common_options(command, options.common);
}

}  // namespace

void add_synth_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("synth", "Video of a speckled ball with exactly known motion");
  auto options = std::make_shared<Options>();
  add_options(*command, *options);
  command->footer(
      "Writes video.*, truth.csv, job.toml and, where the ball is compressed, compression.csv.\n"
      "Row k of truth.csv is the motion from frame k to k + 1; dx, dy at the ball's centre.\n"
      "Example:\n"
      "  impactdic synth -o clip --velocity-px 0.37,-0.61 --rotation-deg 3 --noise 2\n");
  command->callback([command, options] { run_synth(*command, *options); });
}

}  // namespace impactdic::app
