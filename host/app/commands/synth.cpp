#include <impactdic/synth.h>

#include <cstdio>
#include <filesystem>
#include <memory>

#include "host/app/command.h"
#include "host/app/job.h"
#include "host/app/run_context.h"
#include "host/app/terminal_progress.h"
#include "host/run/settings/synth_texts.h"
#include "host/run/synth_files.h"

namespace impactdic::app {
namespace {

struct SynthArguments {
  Common common;
  SynthRequest synth;
  run::SynthTexts texts;
  std::string output, format = "tiff";
};

SynthResult render(const SynthRequest& request, video::FrameSink& sink, bool quiet) {
  TerminalProgress progress("synth", quiet);
  RunControl control;
  control.progress = [&](const Progress& p) { progress(p.done, p.total); };
  return synthesize(
      request, [&](const Frame& frame) { sink.write(frame); }, control);
}

void run_synth(const CLI::App& command, const SynthArguments& options) {
  const video::SinkFormat format = video::parse_sink_format(options.format);
  SynthRequest request = options.synth;
  run::apply(options.texts, request);
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
std::string absolute_path(const std::string& path) {
  return std::filesystem::absolute(path).string();
}

void add_motion_options(CLI::App& command, SynthArguments& options) {
  command
      .add_option("--frames", options.synth.frames,
                  "How many frames; 0: 20, as many as the motion file has, 110 of an impact")
      ->check(CLI::Range(0, 10000000))
      ->capture_default_str();
  command
      .add_option("--velocity-px", options.texts.velocity,
                  "DX,DY: the centre's motion per frame, x right, y down, px; a sphere's third "
                  "number is its motion towards the camera")
      ->capture_default_str();
  command
      .add_option("--rotation-deg", options.texts.step.rotation_deg,
                  "Rotation per frame, counter-clockwise on the screen")
      ->capture_default_str();
  command.add_option(
      "--spin-deg", options.texts.spin,
      "X,Y,Z: a sphere's spin vector per frame, X right, Y up, Z towards the camera; "
      "one number is Z, as --rotation-deg");
  command
      .add_option("--compression", options.texts.step.compression_per_frame,
                  "Share of its diameter by which the ball gets shorter per frame")
      ->check(CLI::Range(0.0, 0.5))
      ->capture_default_str();
  command
      .add_option("--compression-axis-deg", options.texts.step.start.compression_axis_deg,
                  "Axis of the compression, counter-clockwise from image-right")
      ->capture_default_str();
  command.add_option(
      "--start-px", options.texts.start,
      "X,Y: the centre in frame 0; without it the path lies in the picture's middle");
  command
      .add_option(
          "--motion,--poses", options.texts.motion_file,
          "CSV with a row per frame: cx_px,cy_px (or x_px,y_px) or dx_px,dy_px, angle_deg or "
          "rot_deg or a sphere's rotation vector rx_deg,ry_deg,rz_deg, z_px, compression, "
          "compression_axis_deg; a truth.csv is such a file")
      ->transform(absolute_path);
  command
      .add_option("--simulate", options.texts.impact_job,
                  "Job of impactdic simulate: the ball follows the integrated impact, compressed "
                  "along the surface's normal; its diameter is twice --radius-px")
      ->transform(absolute_path);
  command
      .add_option("--touch-frame", options.texts.touch_frame,
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
  number("--fixed-noise", scene.fixed_noise_sigma,
         "The same of noise that stands still: what the sensor adds to each pixel in every frame",
         0, 255);
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

void add_synth_options(CLI::App& command, SynthArguments& options) {
  SynthRequest& request = options.synth;
  command.add_option("-o,--output", options.output, "Folder for the clip and its truth")
      ->required();
  command
      .add_option("--body", options.texts.body,
                  "What is painted: disc, a flat ball that turns in the picture's plane, or sphere")
      ->check(CLI::IsMember({"disc", "sphere"}))
      ->capture_default_str();
  command
      .add_option("--pattern", request.pattern,
                  "Painted ball: a1 … a3, b1 … b3, c1 … c3, d1 … d3, e1, e2, f1, f2; or none")
      ->capture_default_str();
  command.add_option("--seed", request.seed, "Of the pattern and of the noise")
      ->capture_default_str();
  command.add_option("--size", options.texts.size, "WIDTHxHEIGHT of the picture, px")
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
          "--distortion", options.texts.distortion,
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
  auto options = std::make_shared<SynthArguments>();
  add_synth_options(*command, *options);
  command->footer(
      "Writes video.*, truth.csv, job.toml and, where the ball is compressed, compression.csv.\n"
      "Row k of truth.csv is the motion from frame k to k + 1; dx, dy at the ball's centre.\n"
      "Example:\n"
      "  impactdic synth -o clip --velocity-px 0.37,-0.61 --rotation-deg 3 --noise 2\n");
  command->callback([command, options] { run_synth(*command, *options); });
}

}  // namespace impactdic::app
