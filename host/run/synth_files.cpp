#include "host/run/synth_files.h"

#include <algorithm>

#include "sim/speckle/motion.h"

namespace impactdic::run {

std::unique_ptr<video::FrameSink> open_synth_clip(const std::filesystem::path& folder,
                                                  video::SinkFormat format,
                                                  const SynthRequest& request, std::size_t frames) {
  ClipInfo info;
  info.width = request.scene.width;
  info.height = request.scene.height;
  info.bits = request.scene.bits;
  info.fps = request.fps;
  info.frame_count = static_cast<std::int64_t>(frames);
  info.camera = "impactdic synth";
  if (request.exposure > 0) info.exposure_s = request.exposure / request.fps;
  return video::open_sink((folder / ("video" + video::sink_extension(format))).string(), format,
                          info);
}

void write_synth_truth(const std::filesystem::path& folder, const SynthTruth& truth,
                       const SynthRequest& request) {
  if (request.body == SynthBody::kSphere) {
    sim::speckle::write_sphere_truth_csv(folder / "truth.csv", truth.poses, request.radius_px,
                                         request.scene.distance_radii, request.fps);
  } else {
    sim::speckle::write_truth_csv(folder / "truth.csv", truth.poses, request.radius_px,
                                  request.fps);
  }
  if (std::any_of(truth.poses.begin(), truth.poses.end(),
                  [](const BallPose& pose) { return pose.compression != 0; })) {
    sim::speckle::write_compression_csv(folder / "compression.csv", truth.poses);
  }
}

}  // namespace impactdic::run
