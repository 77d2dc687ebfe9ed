#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "host/app/command.h"
#include "host/app/job.h"
#include "host/app/run_context.h"
#include "host/app/synth_motion.h"
#include "host/app/terminal_progress.h"
#include "host/base/parse.h"
#include "host/video/frame_sink.h"
#include "sim/speckle/clip.h"
#ifdef IMPACTDIC_WITH_CODECS
#include "host/video/codec/codec.h"
#endif

namespace impactdic::app {
namespace {

struct Request {
  Common common;
  SynthMotionRequest motion;
  sim::speckle::Scene scene;
  std::string output, pattern = "e1", size = "512x512", format = "tiff";
  double fps = 10000, radius_px = 115, exposure = 0, hidden = 0, bar_level = 90;
  std::uint64_t seed = 1;
};

void parse_size(const std::string& text, sim::speckle::Scene& scene) {
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

sim::speckle::SpeckleBall make_ball(const Request& request) {
  if (request.pattern != "none") {
    return sim::speckle::paint_ball(request.pattern, request.seed, request.radius_px);
  }
  sim::speckle::SpeckleBall plain;
  plain.radius_px = request.radius_px;
  return plain;
}

// The picture in which the ball first leaves the field of view, for a warning.
std::optional<std::size_t> first_cut(const std::vector<sim::speckle::BallPose>& poses,
                                     const Request& request) {
  const double r = request.radius_px;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const sim::speckle::BallPose& p = poses[k];
    if (p.cx_px < r || p.cy_px < r || p.cx_px > request.scene.width - 1 - r ||
        p.cy_px > request.scene.height - 1 - r) {
      return k;
    }
  }
  return std::nullopt;
}

std::unique_ptr<video::FrameSink> open_clip(const std::filesystem::path& folder,
                                            video::SinkFormat format, const Request& request,
                                            std::size_t frames) {
  ClipInfo info;
  info.width = request.scene.width;
  info.height = request.scene.height;
  info.bits = request.scene.bits;
  info.fps = request.fps;
  info.frame_count = static_cast<std::int64_t>(frames);
  info.camera = "impactdic synth";
  if (request.exposure > 0) info.exposure_s = request.exposure / request.fps;
  video::OpenCodecSink codec;
#ifdef IMPACTDIC_WITH_CODECS
  codec = video::open_codec_sink;
#endif
  return video::open_sink((folder / ("video" + video::sink_extension(format))).string(), format,
                          info, codec);
}

void run_synth(const CLI::App& command, Request request) {
  const video::SinkFormat format = video::parse_sink_format(request.format);
  parse_size(request.size, request.scene);
  request.scene.noise_seed = request.seed;
  const SynthMotion motion = make_motion(request.motion, request.scene.width, request.scene.height,
                                         request.fps, request.radius_px);
  if (request.hidden > 0) {
    request.scene.bar = sim::speckle::bar_hiding(request.hidden, motion.poses[motion.bar_frame],
                                                 request.radius_px, motion.surface_angle_deg);
    request.scene.bar->level = request.bar_level;
  }
  const RunContext run(request.common, false);
  const sim::speckle::BallRenderer renderer(make_ball(request), request.scene);
  const auto folder = prepare_output_directory(request.output, request.common.force);
  const auto sink = open_clip(folder, format, request, motion.poses.size());
  write_job(command, folder / "job.toml");
  sim::speckle::write_truth_csv(folder / "truth.csv", motion.poses, request.radius_px, request.fps);
  if (std::any_of(motion.poses.begin(), motion.poses.end(),
                  [](const sim::speckle::BallPose& pose) { return pose.compression != 0; })) {
    sim::speckle::write_compression_csv(folder / "compression.csv", motion.poses);
  }
  if (const auto cut = first_cut(motion.poses, request); cut && !request.common.quiet) {
    std::fprintf(stderr, "impactdic: warning: the ball reaches out of the picture in frame %zu\n",
                 *cut);
  }
  const Stopwatch watch;
  {
    TerminalProgress progress("synth", request.common.quiet);
    sim::speckle::render_clip(
        renderer, motion.poses, request.exposure, [&](const Frame& frame) { sink->write(frame); },
        std::ref(progress));
  }
  sink->finish();
  if (!request.common.quiet) {
    std::printf("%zu frames, %.1f frames/s; clip and truth in %s\n", motion.poses.size(),
                static_cast<double>(motion.poses.size()) / watch.seconds(),
                folder.string().c_str());
  }
}

void add_camera_options(CLI::App& command, Request& request) {
  sim::speckle::Scene& scene = request.scene;
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

void add_options(CLI::App& command, Request& request) {
  command.add_option("-o,--output", request.output, "Folder for the clip and its truth")
      ->required();
  command
      .add_option("--pattern", request.pattern,
                  "Painted ball: a1 … a3, b1 … b3, c1 … c3, d1 … d3, e1, e2, f1, f2; or none")
      ->capture_default_str();
  command.add_option("--seed", request.seed, "Of the pattern and of the noise")
      ->capture_default_str();
  command.add_option("--size", request.size, "WIDTHxHEIGHT of the picture, px")
      ->capture_default_str();
  command.add_option("--fps", request.fps, "Frames a second")
      ->check(positive_number())
      ->capture_default_str();
  command.add_option("--radius-px", request.radius_px, "The ball's radius, px")
      ->check(CLI::Range(20.0, 2000.0))
      ->capture_default_str();
  add_motion_options(command, request.motion);
  add_camera_options(command, request);
  command
      .add_option("--format", request.format,
                  "tiff, png, avi, cine, mraw, raw; also cine10, cine12, mraw12 (packed) and mp4")
      ->capture_default_str();
  add_common_options(command, request.common);
}

}  // namespace

void add_synth_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("synth", "Video of a speckled ball with exactly known motion");
  auto request = std::make_shared<Request>();
  add_options(*command, *request);
  command->footer(
      "Writes video.*, truth.csv, job.toml and, where the ball is compressed, compression.csv.\n"
      "Row k of truth.csv is the motion from frame k to k + 1; dx, dy at the ball's centre.\n"
      "Example:\n"
      "  impactdic synth -o clip --velocity-px 0.37,-0.61 --rotation-deg 3 --noise 2\n");
  command->callback([command, request] { run_synth(*command, *request); });
}

}  // namespace impactdic::app
