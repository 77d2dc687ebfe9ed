#include <impactdic/synth.h>
#include <nanobind/stl/string.h>

#include <cmath>

#include "host/python/arrays.h"
#include "host/python/impact_job.h"
#include "host/python/job.h"
#include "host/python/jobs.h"
#include "host/python/options.h"

namespace nb = nanobind;

namespace impactdic::python {
namespace {

void read_scene(OptionReader& reader, SynthRequest& request) {
  SynthScene& scene = request.scene;
  reader("noise", scene.noise_sigma);
  reader("fixed_noise", scene.fixed_noise_sigma);
  reader("blur", scene.psf_sigma_px);
  reader("exposure", request.exposure);
  reader("shading", scene.shading);
  reader("lamp_deg", scene.lamp_deg);
  reader("lamp", scene.lamp_share);
  reader("lamp_elevation_deg", scene.lamp_elevation_deg);
  reader("limb_darkening", scene.limb_darkening);
  reader("distance", scene.distance_radii);
  reader("distortion_k1", scene.distortion_k1);
  reader("distortion_k2", scene.distortion_k2);
  reader("occlude", request.hidden);
  reader("bar_level", request.bar_level);
  reader("white", scene.white);
  reader("ink", scene.ink);
  reader("background", scene.background);
  reader("bits", scene.bits);
}

// Options whose kinds are the module's own: fixed lists of numbers.
template <typename Take>
void read_numbers(const nb::dict& options, const char* key, std::size_t count, Take take) {
  if (!options.contains(key) || nb::object(options[key]).is_none()) return;
  take(numbers(options[key], count, key));
}

ConstantMotion constant_motion(OptionReader& reader, const nb::dict& options) {
  ConstantMotion motion{{}, 1, 0, 0, 0};
  reader("rotation_deg", motion.rotation_deg);
  reader("compression", motion.compression_per_frame);
  reader("compression_axis_deg", motion.start.compression_axis_deg);
  read_numbers(options, "velocity_px", 3, [&](const std::vector<double>& step) {
    motion.dx_px = step[0];
    motion.dy_px = step[1];
    motion.dz_px = step[2];
  });
  read_numbers(options, "spin_deg", 3, [&](const std::vector<double>& spin) {
    motion.spin_x_deg = spin[0];
    motion.spin_y_deg = spin[1];
    motion.rotation_deg = spin[2];
  });
  return motion;
}

// One row a frame: the columns of BallPose.
GivenMotion given_motion(nb::handle rows) {
  GivenMotion motion;
  for (const nb::handle row : nb::iter(rows)) {
    const std::vector<double> pose = numbers(row, 8, "poses");
    motion.poses.push_back(
        {pose[0], pose[1], pose[2], pose[3], pose[4], pose[5], pose[6], pose[7]});
  }
  motion.placed = true;
  return motion;
}

SynthRequest read_request(const nb::dict& options) {
  SynthRequest request;
  OptionReader reader(options);
  std::string body;
  reader("body", body);
  if (!body.empty() && body != "disc" && body != "sphere") {
    throw InvalidArgument("'" + body + "' is not known", "body", "disc or sphere");
  }
  if (body == "sphere") request.body = SynthBody::kSphere;
  reader("pattern", request.pattern);
  reader("seed", request.seed);
  reader("fps", request.fps);
  reader("radius_px", request.radius_px);
  reader("frames", request.frames);
  read_scene(reader, request);
  for (const char* name : {"velocity_px", "spin_deg", "size", "start_px", "poses", "simulate"}) {
    reader.pass_over(name);
  }
  double touch_frame = SimulatedMotion().touch_frame;
  reader("touch_frame", touch_frame);
  request.motion = constant_motion(reader, options);
  reader.finish("synth");
  read_numbers(options, "size", 2, [&](const std::vector<double>& sides) {
    for (const double side : sides) {
      if (!(side >= 1 && side <= 32768 && side == std::floor(side))) {
        throw InvalidArgument("the size is impossible", "size", "(width, height), whole pixels");
      }
    }
    request.scene.width = static_cast<int>(sides[0]);
    request.scene.height = static_cast<int>(sides[1]);
  });
  read_numbers(options, "start_px", 2, [&](const std::vector<double>& at) {
    request.start = StartPx{at[0], at[1]};
  });
  if (options.contains("poses")) request.motion = given_motion(options["poses"]);
  if (options.contains("simulate")) {
    request.motion =
        SimulatedMotion{impact_job(nb::cast<nb::dict>(options["simulate"])), touch_frame};
  }
  return request;
}

// (frames, 12): the members of BallPose, then the orientation's quaternion.
nb::object poses_of(const SynthTruth& truth) {
  std::vector<double> rows;
  for (const BallPose& pose : truth.poses) {
    const Quaternion q = orientation(pose);
    rows.insert(rows.end(), {pose.cx_px, pose.cy_px, pose.angle_deg, pose.compression,
                             pose.compression_axis_deg, pose.rx_deg, pose.ry_deg, pose.z_px, q.w,
                             q.x, q.y, q.z});
  }
  return to_numpy(std::move(rows), {truth.poses.size(), 12});
}

nb::dict synth(const nb::dict& options, nb::object progress) {
  const SynthRequest request = read_request(options);
  Job job({std::move(progress), nb::none()});
  SynthResult result;
  std::vector<std::uint8_t> bytes;
  std::vector<std::uint16_t> words;
  job.run([&](const RunControl& control) {
    result = synthesize(
        request,
        [&](const Frame& frame) {
          if (frame.type == PixelType::kU8) {
            bytes.insert(bytes.end(), frame.u8.data(), frame.u8.data() + frame.u8.size());
          } else {
            words.insert(words.end(), frame.u16.data(), frame.u16.data() + frame.u16.size());
          }
        },
        control);
  });
  const std::vector<std::size_t> shape{result.frames,
                                       static_cast<std::size_t>(request.scene.height),
                                       static_cast<std::size_t>(request.scene.width)};
  nb::dict made;
  made["film"] = request.scene.bits > 8 ? to_numpy(std::move(words), shape)
                                        : to_numpy(std::move(bytes), shape);
  made["poses"] = poses_of(result.truth);
  made["fps"] = request.fps;
  made["radius_px"] = request.radius_px;
  made["distance_radii"] = request.scene.distance_radii;
  made["surface_angle_deg"] = result.truth.surface_angle_deg;
  made["leaves_view"] = result.truth.leaves_view ? nb::cast(*result.truth.leaves_view) : nb::none();
  made["cancelled"] = result.cancelled;
  return made;
}

}  // namespace

void bind_synth(nb::module_& module) {
  module.def("synth", &synth, nb::arg("options"), nb::arg("progress").none());
}

}  // namespace impactdic::python
