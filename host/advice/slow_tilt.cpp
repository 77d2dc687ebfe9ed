#include "host/advice/slow_tilt.h"

#include <impactdic/units.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/dic/device/ball.h"
#include "host/motion/estimators.h"
#include "host/motion/unseen_tilt.h"
#include "host/sphere/picture_blur.h"

namespace impactdic::advice {
namespace {

// Each may be three times as far as the one before: what that told of the tilt is off by less than
// a speckle there.
constexpr std::array<std::int64_t, 4> kFar = {2, 5, 11, 24};
constexpr double kMostTurn_rad = 2.5;  // in the picture's plane: less than half a turn
constexpr double kMostTilt_rad = 0.6;  // farther, too little is seen in both pictures
// Chance: squares of two deviates together pass this once in three million.
constexpr double kBeyondChance = 30;
// Deviations between the two tilts a frame, and share of them, at most. Light that does not turn
// looks like a tilt that does not grow.
constexpr double kAlike = 5, kAlikeShare = 0.2;
// How much more the ball is stretched one way than across it, from a picture to another.
constexpr double kPressed = 5e-4;
// A tilt that may move the ball by less a frame is none to look into.
constexpr double kUnseen_px = 0.005;
constexpr double kLeastMoved_px = 0.06;  // that the ball's surface moves by
// By how much the flat ball's squares exceed the sphere's, in variances of a pixel, and in shares
// of themselves: chance leaves some units of the first, what no model has of light some thousandths
// of the second.
constexpr double kBetter = 60, kBetterShare = 0.004;

struct TiltAFrame {
  double x_rad = 0, y_rad = 0, sd_rad = 0;  // sd: the larger of both
  double beyond_chance = 0;                 // chi square of two degrees of freedom
  double moved_px = 0;                      // in all
  bool is_better = false;                   // than a flat ball
  bool is_pressed = false;                  // as SlowTilt
  bool is_shown() const {
    return beyond_chance > kBeyondChance && moved_px > kLeastMoved_px && is_better;
  }
  double length_rad() const { return std::hypot(x_rad, y_rad); }
  double unseen_rad() const { return std::hypot(length_rad(), sd_rad); }
};

class FarLook {
 public:
  FarLook(opencl::Engine& engine, const BallPair& pair, const dic::RigidMotion& step,
          const motion::EstimatorOptions& options)
      : first_(pair.first_ball),
        step_(step),
        frames_(engine, 2),
        sphere_(engine, motion::ball_options(options, dic::BallModel::kSphere)),
        flat_(engine, motion::ball_options(options, dic::BallModel::kAffine)) {
    frames_.set(0, pair.first);
  }

  // nullopt where the far picture, so many frames on, could not be registered from the tilt `told`.
  std::optional<TiltAFrame> tilt(const BallPicture& far, double frames, const TiltAFrame& told) {
    frames_.set(1, far.picture);
    dic::RigidMotion start;
    start.dx_px = far.ball.cx_px - first_.cx_px;
    start.dy_px = far.ball.cy_px - first_.cy_px;
    start.rot_x_rad = frames * told.x_rad;
    start.rot_y_rad = frames * told.y_rad;
    start.rot_rad = frames * step_.rot_rad;
    const auto sphere = registered(sphere_, start);
    if (!sphere) return std::nullopt;
    TiltAFrame tilt;
    tilt.x_rad = sphere->rot_x_rad / frames;
    tilt.y_rad = sphere->rot_y_rad / frames;
    const double x_sd = std::sqrt(sphere->covariance[5]), y_sd = std::sqrt(sphere->covariance[9]);
    tilt.sd_rad = std::max(x_sd, y_sd) / std::abs(frames);
    tilt.beyond_chance =
        std::pow(sphere->rot_x_rad / x_sd, 2) + std::pow(sphere->rot_y_rad / y_sd, 2);
    tilt.moved_px = std::hypot(sphere->rot_x_rad, sphere->rot_y_rad) * first_.r_px;
    // Where no tilt is beyond chance, or matters, nothing is to be compared.
    const bool is_beyond = tilt.beyond_chance > kBeyondChance;
    if (!is_beyond && motion::moved_by_tilt_px(tilt.unseen_rad(), first_.r_px) < kUnseen_px) {
      return tilt;
    }
    const auto flat = registered(flat_, flat_start(start));
    tilt.is_better = is_beyond && is_better(*sphere, flat);
    tilt.is_pressed = flat && std::hypot((flat->exx - flat->eyy) / 2, flat->exy) > kPressed;
    return tilt;
  }

 private:
  // The flat ball, which may be pressed, moves by what the sphere's visible half does on average.
  dic::RigidMotion flat_start(dic::RigidMotion start) const {
    start.dx_px += 2 * first_.r_px / 3 * start.rot_y_rad;
    start.dy_px += 2 * first_.r_px / 3 * start.rot_x_rad;
    return start;
  }

  bool is_better(const BallMotion& sphere, const std::optional<BallMotion>& flat) const {
    if (!flat) return true;
    const double worse = std::pow(flat->residual / sphere.residual, 2) - 1;
    const double pixels = kPi * first_.r_px * first_.r_px * sphere.used;
    return worse > kBetterShare && worse * pixels > kBetter;
  }

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
  const double chance = kAlike * std::hypot(a.sd_rad, b.sd_rad);
  const double most = std::hypot(chance, kAlikeShare * std::max(a.length_rad(), b.length_rad()));
  return std::hypot(a.x_rad - b.x_rad, a.y_rad - b.y_rad) < most;
}

// The pictures beside a pair's first one, on the side of the clip where there are more.
class Surroundings {
 public:
  Surroundings(opencl::Engine& engine, const BallPair& pair, const dic::RigidMotion& step,
               const motion::EstimatorOptions& options, const FarFrames& frames)
      : pair_(pair),
        step_(step),
        frames_(frames),
        ahead_(frames.count - 1 - pair.index),
        look_(engine, pair, step, options) {}

  // How far there are pictures in which the ball has not turned too far in the picture's plane.
  std::int64_t farthest() const {
    const double turn_rad = std::max(std::abs(step_.rot_rad), 1e-6);
    return std::min({kFar.back(), std::max(ahead_, pair_.index),
                     static_cast<std::int64_t>(kMostTurn_rad / turn_rad)});
  }

  // The tilt a frame that the picture `n` frames away shows, begun from what is `told` of it.
  std::optional<TiltAFrame> tilt(std::int64_t n, const TiltAFrame& told) {
    const std::int64_t steps = ahead_ >= pair_.index ? n : -n;
    const auto count = static_cast<double>(steps);
    Circle near = pair_.first_ball;
    near.cx_px += count * step_.dx_px;
    near.cy_px += count * step_.dy_px;
    const auto far = frames_.find(pair_.index + steps, near);
    return far ? look_.tilt(*far, count, told) : std::nullopt;
  }

 private:
  const BallPair& pair_;
  const dic::RigidMotion& step_;
  const FarFrames& frames_;
  std::int64_t ahead_;
  FarLook look_;
};

struct Seen {
  std::optional<TiltAFrame> nearer, farther;
};

// From near to far; what was registered last, and before.
Seen approach(Surroundings& around, TiltAFrame told) {
  Seen seen;
  for (const std::int64_t n : kFar) {
    if (n > around.farthest() || static_cast<double>(n) * told.length_rad() > kMostTilt_rad) break;
    const auto tilt = around.tilt(n, told);
    if (!tilt) continue;  // the flight may have ended in between
    seen.nearer = seen.farther;
    seen.farther = told = *tilt;
  }
  return seen;
}

// The farthest picture alone, as of most balls, which hardly tilt; of one that does half the way,
// too.
Seen look_far(Surroundings& around, const TiltAFrame& told) {
  Seen seen;
  const std::int64_t n = around.farthest();
  if (n < 1) return seen;
  seen.farther = around.tilt(n, told);
  if (!seen.farther) return approach(around, told);
  if (n > 1 && seen.farther->is_shown()) seen.nearer = around.tilt(n / 2, *seen.farther);
  return seen;
}

}  // namespace

SlowTilt slow_tilt(opencl::Engine& engine, const BallPair& pair, const dic::RigidMotion& step,
                   const motion::EstimatorOptions& options, const FarFrames& frames) {
  Surroundings around(engine, pair, step, options, frames);
  TiltAFrame told;
  told.x_rad = step.rot_x_rad;
  told.y_rad = step.rot_y_rad;
  const auto [nearer, farther] = look_far(around, told);
  SlowTilt found;
  if (!farther) return found;
  if (nearer && nearer->beyond_chance > kBeyondChance && farther->is_shown() &&
      are_alike(*nearer, *farther)) {
    found.motion = step;
    found.motion->rot_x_rad = farther->x_rad;
    found.motion->rot_y_rad = farther->y_rad;
  } else {
    found.unseen_rad = farther->unseen_rad();
    found.is_pressed = farther->is_pressed;
  }
  return found;
}

}  // namespace impactdic::advice
