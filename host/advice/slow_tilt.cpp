#include "host/advice/slow_tilt.h"

#include <algorithm>
#include <cmath>

#include "host/dic/device/ball.h"
#include "host/motion/estimators.h"
#include "host/sphere/picture_blur.h"

namespace impactdic::advice {
namespace {

constexpr std::int64_t kMostFrames = 24, kFewestFrames = 4;
constexpr double kMostTurn_rad = 2.5;  // in the picture's plane: less than half a turn
// Chance: squares of two deviates together pass this once in three million.
constexpr double kBeyondChance = 30;
constexpr double kAlike = 5;            // deviations between the two tilts a frame, at most
constexpr double kLeastMoved_px = 0.1;  // that the ball's surface moves by
constexpr double kBetter = 0.95;        // of the flat ball's variance is left, at most

struct TiltAFrame {
  double x_rad = 0, x_sd_rad = 0, y_rad = 0, y_sd_rad = 0;
  bool is_shown = false;
};

class FarLook {
 public:
  FarLook(opencl::Engine& engine, const BallPair& pair, const dic::RigidMotion& step,
          const FieldOptions& field)
      : first_(pair.first_ball),
        step_(step),
        frames_(engine, 2),
        sphere_(engine, motion::ball_options(field, dic::BallModel::kSphere)),
        flat_(engine, motion::ball_options(field, dic::BallModel::kRigid)) {
    frames_.set(0, pair.first);
  }

  // nullopt where the far picture, so many frames on, could not be registered.
  std::optional<TiltAFrame> tilt(const BallPicture& far, double frames) {
    frames_.set(1, far.picture);
    dic::RigidMotion start;
    start.dx_px = far.ball.cx_px - first_.cx_px;
    start.dy_px = far.ball.cy_px - first_.cy_px;
    start.rot_rad = frames * step_.rot_rad;
    const auto sphere = registered(sphere_, start), flat = registered(flat_, start);
    if (!sphere) return std::nullopt;
    TiltAFrame tilt{sphere->rot_x_rad / frames, std::sqrt(sphere->covariance[5]) / frames,
                    sphere->rot_y_rad / frames, std::sqrt(sphere->covariance[9]) / frames};
    const double turned_rad = std::hypot(sphere->rot_x_rad, sphere->rot_y_rad);
    const double chance =
        std::pow(tilt.x_rad / tilt.x_sd_rad, 2) + std::pow(tilt.y_rad / tilt.y_sd_rad, 2);
    const bool better =
        !flat || std::pow(sphere->residual, 2) < kBetter * std::pow(flat->residual, 2);
    tilt.is_shown = chance > kBeyondChance && turned_rad * first_.r_px > kLeastMoved_px && better;
    return tilt;
  }

 private:
  std::optional<BallMotion> registered(dic::BallRegistration& registration,
                                       const dic::RigidMotion& start) {
    BallTask task = motion::sphere_task(first_, first_.r_px, sphere::kUsualBlur_px2, start);
    task.second = 1;
    const BallMotion found = registration.measure(frames_, {&task, 1})[0];
    if (found.status != static_cast<idic_int>(WindowStatus::kOk)) return std::nullopt;
    return found;
  }

  Circle first_;
  dic::RigidMotion step_;
  dic::DeviceFrames frames_;
  dic::BallRegistration sphere_, flat_;
};

bool are_alike(const TiltAFrame& a, const TiltAFrame& b) {
  return std::abs(a.x_rad - b.x_rad) < kAlike * std::hypot(a.x_sd_rad, b.x_sd_rad) &&
         std::abs(a.y_rad - b.y_rad) < kAlike * std::hypot(a.y_sd_rad, b.y_sd_rad);
}

}  // namespace

std::optional<dic::RigidMotion> slow_tilt(opencl::Engine& engine, const BallPair& pair,
                                          const dic::RigidMotion& step, const FieldOptions& field,
                                          const FarFrames& frames) {
  const std::int64_t ahead = frames.count - 1 - pair.index;
  const std::int64_t side = ahead >= pair.index ? 1 : -1;
  std::int64_t n =
      std::min({kMostFrames, std::max(ahead, pair.index),
                static_cast<std::int64_t>(kMostTurn_rad / std::max(std::abs(step.rot_rad), 1e-6))});
  FarLook look(engine, pair, step, field);
  std::optional<TiltAFrame> before;
  for (; n >= kFewestFrames; n /= 2) {
    const double steps = static_cast<double>(side * n);
    Circle near = pair.first_ball;
    near.cx_px += steps * step.dx_px;
    near.cy_px += steps * step.dy_px;
    const auto far = frames.find(pair.index + side * n, near);
    const auto tilt = far ? look.tilt(*far, steps) : std::nullopt;
    if (!tilt) continue;  // the flight may have ended in between
    if (!tilt->is_shown || (before && !are_alike(*before, *tilt))) return std::nullopt;
    if (before) {
      dic::RigidMotion tilted = step;
      tilted.rot_x_rad = before->x_rad;
      tilted.rot_y_rad = before->y_rad;
      return tilted;
    }
    before = tilt;
  }
  return std::nullopt;
}

}  // namespace impactdic::advice
