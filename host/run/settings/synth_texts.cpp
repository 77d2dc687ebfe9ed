#include "host/run/settings/synth_texts.h"

#include <impactdic/error.h>

#include <cmath>

#include "host/base/parse.h"
#include "sim/job/job_toml.h"
#include "sim/speckle/motion.h"

namespace impactdic::run {
namespace {

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
void refuse_constant_motion(const SynthTexts& texts, const std::string& source) {
  if (texts.velocity != SynthTexts::kUsualVelocity || texts.step.rotation_deg != 0 ||
      !texts.spin.empty() || texts.step.compression_per_frame != 0) {
    throw InvalidArgument("the motion is given twice", source,
                          "leave out --velocity-px, --rotation-deg, --spin-deg and --compression");
  }
}

ConstantMotion constant_motion(const SynthTexts& texts) {
  ConstantMotion motion = texts.step;
  const std::vector<double> step = parse_doubles(texts.velocity, ',', 0, "--velocity-px");
  if (step.size() != 2 && step.size() != 3) {
    throw InvalidArgument("'" + texts.velocity + "' is no velocity", "--velocity-px",
                          "DX,DY or DX,DY,DZ");
  }
  motion.dx_px = step[0];
  motion.dy_px = step[1];
  if (step.size() == 3) motion.dz_px = step[2];
  if (texts.spin.empty()) return motion;
  if (motion.rotation_deg != 0) {
    throw InvalidArgument("the rotation is given twice", "--rotation-deg, --spin-deg",
                          "choose one");
  }
  const std::vector<double> spin = parse_doubles(texts.spin, ',', 0, "--spin-deg");
  if (spin.size() != 1 && spin.size() != 3) {
    throw InvalidArgument("'" + texts.spin + "' is no spin", "--spin-deg", "X,Y,Z or Z");
  }
  motion.rotation_deg = spin.back();
  if (spin.size() == 3) {
    motion.spin_x_deg = spin[0];
    motion.spin_y_deg = spin[1];
  }
  return motion;
}

void read_motion(const SynthTexts& texts, SynthRequest& request) {
  if (!texts.motion_file.empty() && !texts.impact_job.empty()) {
    throw InvalidArgument("the motion is given twice", "--motion, --simulate", "choose one");
  }
  if (!texts.impact_job.empty()) {
    refuse_constant_motion(texts, "--simulate");
    request.motion =
        SimulatedMotion{sim::job::read_simulate_job(texts.impact_job).impact, texts.touch_frame};
  } else if (!texts.motion_file.empty()) {
    refuse_constant_motion(texts, "--motion");
    request.motion = sim::speckle::read_motion_csv(texts.motion_file);
  } else {
    request.motion = constant_motion(texts);
  }
  if (!texts.start.empty()) {
    const std::vector<double> at = parse_doubles(texts.start, ',', 2, "--start-px");
    request.start = StartPx{at[0], at[1]};
  }
}

}  // namespace

void apply(const SynthTexts& texts, SynthRequest& request) {
  if (!texts.distortion.empty()) request.scene.distortion_k1 = texts.distortion.front();
  if (texts.distortion.size() > 1) request.scene.distortion_k2 = texts.distortion.back();
  if (texts.body == "sphere") request.body = SynthBody::kSphere;
  parse_size(texts.size, request.scene);
  read_motion(texts, request);
}

}  // namespace impactdic::run
