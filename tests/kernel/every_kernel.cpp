// Runs every kernel once on small cases, for a checker such as oclgrind to look over: on whatever
// device `auto` takes there. Exit status 0 where everything ran; whether the figures are right is
// the business of the other kernel tests (a simulated device need not round as real ones do).
//   every_kernel CASE     one of the cases below
#include <impactdic/error.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <map>
#include <string>

#include "host/circle/device/rim_follower.h"
#include "host/dic/device/ball.h"
#include "host/dic/device/equal.h"
#include "host/dic/device/icgn.h"
#include "host/dic/device/published.h"
#include "host/dic/device/ring.h"
#include "host/dic/device/zncc.h"
#include "sim/speckle/render.h"
#include "sim/speckle/speckle_field.h"

namespace impactdic {
namespace {

constexpr int kWidth = 47, kHeight = 45;
constexpr double kU = 1.3, kV = -0.6;

struct Setting {
  opencl::Engine engine;
  dic::DeviceFrames frames;
  opencl::Buffer<Window> windows;
  opencl::Buffer<WindowMotion> motions;
  std::size_t count = 0;

  explicit Setting(int bits) : engine("auto", options()), frames(engine, 2) {
    const sim::speckle::SpeckleField surface(150, 50, 1.5, 3);
    frames.set(0, surface.render(kWidth, kHeight, 0, 0, 0, 0, 0, bits));
    frames.set(1, surface.render(kWidth, kHeight, kU, kV, 0, 0, 0, bits));
    // In the middle, at a corner with half of its search area outside, outside, and turned.
    const std::vector<Window> list = {{0, 1, 20, 18, 0, 0, 0},
                                      {0, 1, 1, 1, 1, -1, 0},
                                      {0, 1, kWidth - 3, 9, 0, 0, 0},
                                      {0, 1, 22, 19, 1, 0, 0.1F},
                                      {0, 1, 15, 20, 100, -100, 0}};
    count = list.size();
    windows = opencl::make_buffer<Window>(engine, list);
    motions = opencl::Buffer<WindowMotion>(engine, count);
  }
  static opencl::EngineOptions options() {
    opencl::EngineOptions out;
    out.cache_dir = "";
    return out;
  }
  // Waits for the kernels and says what became of the window in the middle.
  void finish() {
    const WindowMotion motion = motions.to_vector(engine)[0];
    std::printf("status %d, (%.4f, %.4f) px\n", motion.status, motion.u, motion.v);
  }
};

FieldOptions small_options(FieldMethod method) {
  FieldOptions options;
  options.method = method;
  options.window_px = 9;
  options.search_px = 3;
  options.interp_points = 1;
  options.spline_degree = 3;
  return options;
}

void run_zncc(const dic::ZnccVariant& variant, int bits) {
  Setting setting(bits);
  dic::ZnccOpencl zncc(setting.engine, small_options(FieldMethod::kZncc), variant);
  zncc.run(setting.frames, setting.windows, setting.count, setting.motions);
  setting.finish();
}

void run_equal(const dic::EqualVariant& variant, int window_px = 16) {
  Setting setting(8);
  FieldOptions options = small_options(FieldMethod::kZncc);
  options.window_px = window_px;
  dic::EqualOpencl(setting.engine, options, variant)
      .run(setting.frames, setting.windows, setting.count, setting.motions, 3);
  setting.finish();
}

void run_published() {
  Setting setting(8);
  dic::PublishedOpencl published(setting.engine, small_options(FieldMethod::kPublished));
  published.run(setting.frames, setting.windows, setting.count, setting.motions);
  setting.finish();
}

void run_icgn() {
  Setting setting(8);
  const FieldOptions options = small_options(FieldMethod::kIcgn);
  dic::IcgnRefiner refiner(setting.engine, options, 2);
  std::vector<WindowMotion> seeds(setting.count);
  for (WindowMotion& seed : seeds) seed = {1.0F, -1.0F};
  setting.motions.write(setting.engine, seeds);
  refiner.refine(setting.frames, setting.windows, setting.count, setting.motions);
  setting.finish();
}

void run_ball(dic::BallModel model, const BallSight& sight = {}, bool free_centre = false) {
  Setting setting(8);
  dic::BallOptions options;
  options.model = model;
  options.free_centre = free_centre;
  options.spline_degree = 3;
  dic::BallRegistration ball(setting.engine, options);
  const BallTask task{0, 1, 23, 22, 12, 1, -1, 0, 14, 0.75F, 0.05F, 0, 0, sight};
  const BallMotion motion = ball.measure(setting.frames, {&task, 1})[0];
  std::printf("status %d, (%.4f, %.4f) px\n", motion.status, motion.dx, motion.dy);
}

void run_ring() {
  Setting setting(8);
  dic::RingOptions options;
  options.spline_degree = 3;
  options.rings = 4;
  options.angles = 32;
  dic::RingRotation ring(setting.engine, options);
  const RingTask task{0, 1, 23, 22, 24.3F, 21.4F, 4, 12};
  const dic::RingMotion motion = ring.measure(setting.frames, {&task, 1})[0];
  std::printf("status %d, %.4f rad\n", static_cast<int>(motion.status), motion.rot_rad);
}

void run_rim() {
  SynthScene scene;
  scene.width = scene.height = 112;
  scene.noise_sigma = 2;
  const sim::speckle::BallRenderer renderer(sim::speckle::paint_ball("c2", 7, 40), scene);
  Frame frame;
  renderer.render(BallPose{55.6, 56.2, 0}, 0, frame);
  circle::CirclePrior prior;
  prior.predicted = {55.6, 56.2, 40};
  prior.centre_sd_px = 0.05;
  prior.rim_sd_px = 0.3;
  const circle::CircleFit learnt = circle::measure_circle(frame, prior, {});
  prior.rim_model = learnt.rim_model;
  prior.bright = learnt.bright;
  opencl::Engine engine("auto", Setting::options());
  dic::DeviceFrames frames(engine, 1);
  frames.set(0, frame);
  circle::RimFollower follower(engine, {});
  const circle::RimToFollow rim{&frame, 0, 0, 0, prior};
  const auto fit = follower.follow(frames, {&rim, 1})[0];
  std::printf("followed %d, (%.4f, %.4f) px\n", fit.has_value(), fit ? fit->circle.cx_px : 0,
              fit ? fit->circle.cy_px : 0);
}

const std::map<std::string, std::function<void()>> kCases = {
    {"zncc_pairs_scalar",
     [] {
       run_zncc({dic::ZnccPath::kPairs, 16, 1, 16, true, false, 0}, 8);
     }},
    {"zncc_pairs_vector",
     [] {
       run_zncc({dic::ZnccPath::kPairs, 16, 4, 1}, 12);
     }},
    {"equal_scalar",
     [] {
       run_equal({1, 16, 2, true, false, 0});
     }},
    {"equal_bytes",
     [] {
       run_equal({1, 32, 1, true, false, 0, true}, 32);
     }},
    {"equal_vector",
     [] {
       run_equal({4, 1, 1, false, false, 0});
     }},
    {"zncc_bytes",
     [] {
       run_zncc({dic::ZnccPath::kBytes, 16, 1, 32, true}, 8);
     }},
    {"zncc_scalar",
     [] {
       run_zncc({dic::ZnccPath::kSingle, 16, 1, 16, true, false, 0}, 8);
     }},
    {"zncc_vector",
     [] {
       run_zncc({dic::ZnccPath::kSingle, 16, 4, 1}, 12);
     }},
    {"zncc_vector_lanes",
     [] {
       run_zncc({dic::ZnccPath::kSingle, 16, 4, 2}, 8);
     }},
    {"zncc_clfft",
     [] {
       run_zncc({dic::ZnccPath::kClfft, 15, 1, 1}, 8);
     }},
    {"published", run_published},
    {"icgn", run_icgn},
    {"ball", [] { run_ball(dic::BallModel::kRigid); }},
    {"ball_sphere", [] { run_ball(dic::BallModel::kSphere); }},
    {"ball_shaped",
     [] {
       run_ball(dic::BallModel::kSphereAndRadius,
                {3e-3F, 0.01F, -0.02F, 0.01F, -0.02F, {-0.02F, 0.001F, 0}, {-0.03F, 0, 0}}, true);
     }},
    {"ball_affine", [] { run_ball(dic::BallModel::kAffine); }},
    {"ring", run_ring},
    {"rim", run_rim},
};

}  // namespace
}  // namespace impactdic

int main(int count, char** arguments) {
  const auto& cases = impactdic::kCases;
  const auto found = cases.find(count == 2 ? arguments[1] : "");
  if (found == cases.end()) {
    for (const auto& [name, run] : cases) std::printf("%s\n", name.c_str());
    return 2;
  }
  try {
    found->second();
    return 0;
  } catch (const impactdic::Error& error) {
    std::fprintf(stderr, "every_kernel: %s\n", error.line().c_str());
    return 1;
  }
}
