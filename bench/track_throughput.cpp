// `impactdic track` from a clip in the page cache to its files: frames a second of the whole
// program, with the error against the truth beside it. Renders a ball that goes around once and
// plays that again and again; a sphere turns about a tilted axis. JSON on standard output.
//   track_throughput PROGRAM FOLDER [--frames N] [--distinct N] [--format mraw|cine|...]
//                    [--body disc|sphere] [-- options of track]
#include <impactdic/error.h>
#include <impactdic/units.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host/base/parse.h"
#include "host/base/stopwatch.h"
#include "host/report/csv.h"
#include "host/video/frame_sink.h"
#include "sim/speckle/render.h"
#include "sim/speckle/sphere/sphere_render.h"

namespace impactdic::bench {
namespace {

constexpr double kRadius = 115;

struct Request {
  std::string program, folder, format = "mraw", body = "disc", options;
  std::int64_t frames = 20000, distinct = 720;
};

Request parse(int argc, char** argv) {
  if (argc < 3) {
    throw InvalidArgument(
        "usage: track_throughput PROGRAM FOLDER [--frames N] [--distinct N] "
        "[--format F] [--body disc|sphere] [-- options of track]");
  }
  Request request;
  request.program = argv[1];
  request.folder = argv[2];
  int i = 3;
  for (; i + 1 < argc && std::string(argv[i]) != "--"; i += 2) {
    const std::string name = argv[i], value = argv[i + 1];
    if (name == "--frames") {
      request.frames = parse_int(value, name);
    } else if (name == "--distinct") {
      request.distinct = parse_int(value, name);
    } else if (name == "--format") {
      request.format = value;
    } else if (name == "--body" && (value == "disc" || value == "sphere")) {
      request.body = value;
    } else {
      throw InvalidArgument("no such option", name);
    }
  }
  for (++i; i < argc; ++i) request.options += std::string(" ") + argv[i];
  return request;
}

// Unit vector, camera axes: a disc turns about the line of sight, a sphere about a tilted axis.
struct Axis {
  double x, y, z;
};
Axis axis_of(const Request& request) {
  return request.body == "sphere" ? Axis{0.48, 0.6, 0.64} : Axis{0, 0, 1};
}

// Once around a circle and once about itself in `distinct` frames.
BallPose pose_of(std::int64_t frame, const Request& request) {
  const double turn =
      static_cast<double>(frame % request.distinct) / static_cast<double>(request.distinct);
  const double at = 2 * kPi * turn;
  const Axis axis = axis_of(request);
  BallPose pose{255.63 + 60 * std::cos(at), 255.41 + 60 * std::sin(at), 360 * turn * axis.z};
  pose.rx_deg = 360 * turn * axis.x;
  pose.ry_deg = 360 * turn * axis.y;
  return pose;
}

std::unique_ptr<sim::speckle::FrameRenderer> renderer_of(const Request& request,
                                                         const SynthScene& scene) {
  if (request.body == "sphere") {
    return std::make_unique<sim::speckle::SphereRenderer>(
        sim::speckle::paint_sphere("e1", 7, kRadius), scene);
  }
  return std::make_unique<sim::speckle::BallRenderer>(sim::speckle::paint_ball("e1", 7, kRadius),
                                                      scene);
}

void write_clip(const Request& request, const std::string& path, video::SinkFormat format) {
  SynthScene scene;
  scene.noise_sigma = 2;
  const auto renderer = renderer_of(request, scene);
  std::vector<Frame> frames(static_cast<std::size_t>(request.distinct));
  for (std::int64_t k = 0; k < request.distinct; ++k) {
    renderer->render(pose_of(k, request), k, frames[static_cast<std::size_t>(k)]);
  }
  ClipInfo info;
  info.width = scene.width;
  info.height = scene.height;
  info.bits = 8;
  info.fps = 10000;
  info.frame_count = request.frames;
  const auto sink = video::open_sink(path, format, info);
  for (std::int64_t i = 0; i < request.frames; ++i) {
    sink->write(frames[static_cast<std::size_t>(i % request.distinct)]);
  }
  sink->finish();
}

struct Rms {
  double squares = 0;
  std::int64_t count = 0;
  void add(double error) {
    squares += error * error;
    ++count;
  }
  double value() const { return std::sqrt(squares / static_cast<double>(count)); }
};

nlohmann::json errors(const std::vector<TrackRow>& rows, const Request& request) {
  const double step_deg = 360.0 / static_cast<double>(request.distinct);
  const Axis axis = axis_of(request);
  Rms centre, motion, rotation, across;
  std::int64_t ok = 0;
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
    const TrackRow& row = rows[i];
    const BallPose a = pose_of(row.frame, request), b = pose_of(row.frame + 1, request);
    if (row.status != TrackStatus::kOk) continue;
    ++ok;
    centre.add(row.cx_px - a.cx_px);
    centre.add(row.cy_px - a.cy_px);
    if (!row.motion_ok) continue;
    motion.add(row.dx_px - (b.cx_px - a.cx_px));
    motion.add(row.dy_px - (b.cy_px - a.cy_px));
    rotation.add(row.rot_deg - step_deg * axis.z);
    if (request.body != "sphere") continue;
    across.add(row.rot_x_deg - step_deg * axis.x);
    across.add(row.rot_y_deg - step_deg * axis.y);
  }
  nlohmann::json result = {{"frames_ok", ok},
                           {"rms_centre_px", centre.value()},
                           {"rms_motion_px", motion.value()},
                           {"rms_rotation_deg", rotation.value()}};
  if (request.body == "sphere") result["rms_rotation_xy_deg"] = across.value();
  return result;
}

int run(const Request& request) {
  namespace fs = std::filesystem;
  fs::create_directories(request.folder);
  const video::SinkFormat format = video::parse_sink_format(request.format);
  // Called by what it shows: another clip that lies there from an earlier run is not this one.
  const std::string stem = request.folder + "/" + request.body + "_" +
                           std::to_string(request.frames) + "_of_" +
                           std::to_string(request.distinct);
  const std::string out = request.folder + "/out";
  const bool photron =
      format == video::SinkFormat::kMraw || format == video::SinkFormat::kMrawPacked12;
  const std::string path = stem + video::sink_extension(format),
                    clip = photron ? stem + ".cihx" : path;
  if (!fs::exists(clip)) write_clip(request, path, format);
  const std::string command =
      request.program + " track " + clip + " -o " + out + " --force" + request.options + " 1>&2";
  fs::remove_all(out);  // to take back the memory of an earlier run's files is not this run's work
  const Stopwatch watch;
  const int status = std::system(command.c_str());
  const double wall_s = watch.seconds();
  if (status != 0) throw Error("the program failed: " + command);
  nlohmann::json summary;
  std::ifstream(out + "/summary.json") >> summary;
  nlohmann::json result = errors(report::read_track_csv(out + "/track.csv"), request);
  result["command"] = "track" + request.options;
  result["format"] = request.format;
  result["frames"] = request.frames;
  result["device"] = summary["device"];
  result["frames_per_s"] = summary["frames_per_s"];
  result["frames_per_s_with_start_and_end"] = static_cast<double>(request.frames) / wall_s;
  result["checksum_wait_s"] = summary["checksum_wait_s"];
  std::printf("%s\n", result.dump(1).c_str());
  return 0;
}

}  // namespace
}  // namespace impactdic::bench

int main(int argc, char** argv) {
  try {
    return impactdic::bench::run(impactdic::bench::parse(argc, argv));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "track_throughput: %s\n", error.what());
    return 1;
  }
}
