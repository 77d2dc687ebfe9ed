// The estimators behind make_motion_estimator; arguments as there.
#pragma once

#include <memory>

#include "host/dic/device/ball.h"
#include "host/dic/sphere/sphere_errors.h"
#include "host/motion/motion_estimator.h"
#include "kernels/types.h"

namespace impactdic::motion {

std::unique_ptr<MotionEstimator> make_field_estimator(opencl::Engine& engine,
                                                      const EstimatorOptions& options,
                                                      double radius_px, dic::DeviceFrames& frames);
std::unique_ptr<MotionEstimator> make_ring_estimator(opencl::Engine& engine,
                                                     const EstimatorOptions& options,
                                                     double radius_px, dic::DeviceFrames& frames);
// The rings of a pair: between the balls' centres, from a sixth of the radius to just within the
// rim.
RingTask ring_task(const PairMotion& pair, double radius_px);
std::unique_ptr<MotionEstimator> make_ball_estimator(opencl::Engine& engine,
                                                     const EstimatorOptions& options,
                                                     double radius_px, dic::DeviceFrames& frames);

std::unique_ptr<MotionEstimator> make_sphere_estimator(opencl::Engine& engine,
                                                       const EstimatorOptions& options,
                                                       double radius_px, dic::DeviceFrames& frames);

// A pair's turn sought without a guess.
SphereSearchTask search_task(const PairMotion& pair, double radius_px);
// The registration of a sphere from `start`, without its slots, and what comes of it. `blur_px2`:
// BallTask.blur.
BallTask sphere_task(const Circle& circle, double radius_px, double blur_px2,
                     const dic::RigidMotion& start);
// How a pair's sphere is seen, whose round outline has the radius `rim_px`.
BallSight pair_sight(const PairMotion& pair, const Perspective& perspective, double rim_px);
// `source`: of what the registration was told, whose errors are part of what the deviations say;
// its radius is the ball's.
dic::RigidMotion sphere_motion(const BallMotion& ball, dic::SphereSource source = {});

// How the whole ball is registered where windows are measured with `field`.
dic::BallOptions ball_options(const FieldOptions& field, dic::BallModel model);
// The same without what stands still before the clip's ball.
dic::BallOptions ball_options(const EstimatorOptions& options, dic::BallModel model);
// The same of the body that it is taken for: a sphere in its light, or a rigid disc.
dic::BallOptions body_options(const EstimatorOptions& options);

}  // namespace impactdic::motion
