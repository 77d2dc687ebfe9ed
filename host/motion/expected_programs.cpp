#include "host/motion/expected_programs.h"

#include <utility>

#include "host/circle/device/rim_follower.h"
#include "host/dic/window_correlator.h"
#include "host/motion/estimators.h"
#include "host/motion/pose/turned_centres.h"

namespace impactdic::motion {

std::vector<opencl::ProgramRequest> expected_programs(const opencl::Engine& engine,
                                                      const EstimatorOptions& options,
                                                      const ExpectedClip& clip) {
  if (options.estimator == Estimator::kRing) return {};
  using enum dic::BallModel;
  const auto ball = [&](dic::BallModel model, bool shaped) {
    return dic::BallRegistration::program(engine, ball_options(options.field, model), shaped);
  };
  dic::BallOptions far = ball_options(options.field, kSphereRadiusAndDistance);
  far.free_centre = true;
  const dic::BallOptions turned =
      TurnedCentres::with_free_centre(ball_options(options.field, kSphere));
  const bool is_ball = options.estimator == Estimator::kBall;
  const bool looks = is_ball && (clip.any_body || options.sphere);
  std::vector<opencl::ProgramRequest> all;
  if (looks) all.push_back(ball(kSphere, false));
  const auto windows = dic::WindowCorrelator::programs(engine, options.field, clip.type);
  all.insert(all.end(), windows.begin(), windows.end());
  if (is_ball) {
    const dic::BallOptions whole = ball_options(options.field, kRigid);
    // Behind the search for windows, which takes as long as a sphere.
    const auto place =
        all.end() - (windows.empty() ? 0 : static_cast<std::ptrdiff_t>(windows.size()) - 1);
    all.insert(place, {ball(kRigid, false), dic::SplineFrames::program(engine, whole.spline_degree,
                                                                       whole.presmooth_sigma_px)});
  }
  // Discs' circles, from the second batch on.
  const bool is_long = clip.frames >= circle::RimFollower::kLongClip;
  if (engine.device().is_gpu && is_long && !options.sphere) {
    all.push_back(circle::RimFollower::program({}, clip.type));
  }
  // What unpacks pictures is asked for at once, and takes no time.
  if (looks) {
    for (opencl::ProgramRequest perhaps :
         {dic::BallRegistration::program(engine, far, true), ball(kSphere, true),
          ball(kSphereAndRadius, false), dic::BallRegistration::program(engine, turned, false)}) {
      perhaps.is_sure = options.sphere;
      all.push_back(std::move(perhaps));
    }
  }
  return all;
}

}  // namespace impactdic::motion
