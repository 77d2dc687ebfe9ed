#include "host/motion/motion_estimator.h"

#include <impactdic/error.h>

#include <array>

#include "host/motion/estimators.h"

namespace impactdic {
namespace {
constexpr std::array kNames = {"field", "ring", "ball"};
}  // namespace

const char* to_string(Estimator estimator) { return kNames[static_cast<std::size_t>(estimator)]; }

Estimator parse_estimator(const std::string& name) {
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (name == kNames[i]) return static_cast<Estimator>(i);
  }
  throw InvalidArgument("'" + name + "' is not an estimator", "--estimator",
                        "there are field, ring and ball");
}

}  // namespace impactdic

namespace impactdic::motion {

void EstimatorOptions::validate() const {
  field.validate();
  if (sphere && estimator != Estimator::kBall) {
    throw InvalidArgument("measures turns in the picture alone", "--estimator",
                          "a sphere needs ball");
  }
  if (spacing_px < 0) throw InvalidArgument("the spacing must be at least 1 px", "--spacing");
}

std::unique_ptr<MotionEstimator> make_motion_estimator(opencl::Engine& engine,
                                                       const EstimatorOptions& options,
                                                       double radius_px,
                                                       dic::DeviceFrames& frames) {
  options.validate();
  switch (options.estimator) {
    case Estimator::kField:
      return make_field_estimator(engine, options, radius_px, frames);
    case Estimator::kRing:
      return make_ring_estimator(engine, options, radius_px, frames);
    case Estimator::kBall:
      return options.sphere ? make_sphere_estimator(engine, options, radius_px, frames)
                            : make_ball_estimator(engine, options, radius_px, frames);
  }
  throw InvalidArgument("no such estimator");
}

}  // namespace impactdic::motion
