#include "host/advice/sphere_radius.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>

#include "host/base/weighted_mean.h"
#include "host/dic/device/ball.h"
#include "host/dic/sphere/rotation.h"
#include "host/motion/estimators.h"
#include "host/sphere/source_response.h"

namespace impactdic::advice {
namespace {

constexpr double kTilt_deg = 25;     // farther, too little is seen in both pictures
constexpr std::int64_t kFewest = 2;  // frames; one is what the pair itself shows
// Beside chance: what a free radius is off by, since blur acts in the picture and foreshortening
// does not move it along (four patterns, R 115 px: 0.09 px at most), and a circle as the texture
// turns under its rim.
constexpr double kFreeSd_px = 0.08, kCircleSd_px = 0.03;

double tilt_deg(const Eigen::Vector3d& turn) {
  const double towards = dic::quaternion_of(turn).toRotationMatrix()(2, 2);
  return std::acos(std::clamp(towards, -1.0, 1.0)) * kDegPerRad;
}

// Frames until the ball is tilted so far, or has turned half around.
std::int64_t frames_to_tilt(const Eigen::Vector3d& step, std::int64_t most) {
  std::int64_t n = 1;
  while (n < most && tilt_deg(static_cast<double>(n) * step) < kTilt_deg &&
         static_cast<double>(n + 1) * step.norm() < kPi) {
    ++n;
  }
  return n;
}

class FarRegistration {
 public:
  FarRegistration(opencl::Engine& engine, const BallPair& pair, const FieldOptions& field,
                  const motion::Perspective& perspective)
      : perspective_(perspective),
        first_ball_(motion::about_centre(pair.first_ball, perspective)),
        frames_(engine, 2),
        free_(engine, motion::ball_options(field, dic::BallModel::kSphereAndRadius)),
        given_(engine, motion::ball_options(field, dic::BallModel::kSphere)) {
    frames_.set(0, pair.first);
  }

  // `turn`: rotation vector that is expected, rad.
  std::optional<Measured> radius(const BallPicture& far, const Eigen::Vector3d& turn) {
    frames_.set(1, far.picture);
    dic::RigidMotion start;
    const Circle far_ball = motion::about_centre(far.ball, perspective_);
    start.dx_px = far_ball.cx_px - first_ball_.cx_px;
    start.dy_px = far_ball.cy_px - first_ball_.cy_px;
    start.rot_x_rad = turn.x();
    start.rot_y_rad = turn.y();
    start.rot_rad = turn.z();
    const auto found = registered(free_, first_ball_.r_px, start);
    if (!found || !(found->ball_radius_sd > 0)) return std::nullopt;
    const double radius_px = found->ball_radius;
    const auto given = registered(given_, radius_px, motion::sphere_motion(*found, 0));
    if (!given) return std::nullopt;
    WeightedMean sum;
    sum.add(radius_px, std::hypot(found->ball_radius_sd, kFreeSd_px));
    add_circles(motion::sphere_motion(*given, 0), start, radius_px, sum);
    return Measured{sum.value(), sum.sd()};
  }

 private:
  std::optional<BallMotion> registered(dic::BallRegistration& registration, double radius_px,
                                       const dic::RigidMotion& start) {
    BallTask task = motion::sphere_task(first_ball_, radius_px, start);
    task.second = 1;
    task.sight = motion::sight_of(perspective_, first_ball_.r_px, {first_ball_, {}}, {},
                                  first_ball_.cx_px, first_ball_.cy_px);
    const BallMotion motion = registration.measure(frames_, {&task, 1})[0];
    if (motion.status != static_cast<idic_int>(WindowStatus::kOk)) return std::nullopt;
    return motion;
  }

  // The radii with which the displacements would be those of the circles.
  static void add_circles(const dic::RigidMotion& motion, const dic::RigidMotion& of_circles,
                          double radius_px, WeightedMean& sum) {
    const auto response =
        sphere::source_response({motion.rot_x_rad, motion.rot_y_rad, motion.rot_rad}, radius_px);
    const auto add = [&](double circles, double measured, double measured_sd, double slope) {
      const double sd_px = std::hypot(measured_sd, kCircleSd_px);
      if (slope != 0) sum.add(radius_px + (circles - measured) / slope, sd_px / std::abs(slope));
    };
    add(of_circles.dx_px, motion.dx_px, motion.dx_sd_px, response.dx[sphere::kToRadius]);
    add(of_circles.dy_px, motion.dy_px, motion.dy_sd_px, response.dy[sphere::kToRadius]);
  }

  motion::Perspective perspective_;
  Circle first_ball_;
  dic::DeviceFrames frames_;
  dic::BallRegistration free_, given_;
};

}  // namespace

std::optional<Measured> radius_from_turn(opencl::Engine& engine, const BallPair& pair,
                                         const dic::RigidMotion& step, const FieldOptions& field,
                                         const motion::Perspective& perspective,
                                         const FarFrames& frames) {
  const Eigen::Vector3d turn(step.rot_x_rad, step.rot_y_rad, step.rot_rad);
  const std::int64_t ahead = frames.count - 1 - pair.index;
  std::int64_t n = frames_to_tilt(turn, std::max(ahead, pair.index));
  const int side = n <= ahead || ahead >= pair.index ? 1 : -1;
  FarRegistration registration(engine, pair, field, perspective);
  for (; n >= kFewest; n /= 2) {
    const double steps = side * static_cast<double>(n);
    Circle near = pair.first_ball;
    near.cx_px += steps * step.dx_px;
    near.cy_px += steps * step.dy_px;
    const auto far = frames.find(pair.index + side * n, near);
    if (!far) continue;
    if (const auto radius = registration.radius(*far, steps * turn)) return radius;
  }
  return std::nullopt;
}

}  // namespace impactdic::advice
