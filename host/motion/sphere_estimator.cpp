#include <algorithm>
#include <cmath>

#include "host/dic/device/sphere_search.h"
#include "host/dic/sphere/rotation.h"
#include "host/motion/estimators.h"
#include "host/motion/shape_doubt.h"

namespace impactdic::motion {
namespace {

// One registration of the whole sphere, started from the field. Where the windows found little, the
// turn is sought over all of SO(3), and the windows look again where it was found.
class SphereEstimator : public MotionEstimator {
 public:
  SphereEstimator(opencl::Engine& engine, const EstimatorOptions& options, double radius_px,
                  dic::DeviceFrames& frames)
      : radius_px_(options.sphere_radius(radius_px)),
        radius_sd_px_(options.sphere_radius_sd_px),
        rim_px_(radius_px),
        blur_px2_(options.sphere_blur_px2),
        light_(options.sphere_light),
        perspective_(options.perspective),
        field_(make_field_estimator(engine, options, radius_px, frames)),
        frames_(frames),
        sphere_(engine, body_options(options)),
        search_(engine) {}

  std::span<const Window> grid() const override { return field_->grid(); }
  double fit_seconds() const override { return field_->fit_seconds(); }

  void aim(std::span<PairMotion> pairs) override {
    field_->aim(pairs);
    for (PairMotion& pair : pairs) {
      if (!is_found(pair)) search(pair);
    }
  }

  void measure(std::span<PairMotion> pairs) override {
    field_->measure(pairs);
    for (PairMotion& pair : pairs) {
      if (pair.near_contact) share_shape(pair);
    }
    std::vector<BallMotion> motions = measure_all(pairs);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (!is_ok(motions[i]) && search(pairs[i])) motions[i] = measure_anew(pairs[i]);
      if (is_ok(motions[i])) {
        take_over(motions[i], pairs[i]);
        continue;
      }
      // A field that the whole ball does not bear out is chance.
      pairs[i].motion.ok = false;
      if (pairs[i].status == TrackStatus::kOk) pairs[i].status = TrackStatus::kLowCorrelation;
    }
  }

 private:
  // Of the windows that could be found, the share that must agree for a start.
  static constexpr double kWellFound = 0.3;

  static bool is_ok(const BallMotion& motion) {
    return motion.status == static_cast<idic_int>(WindowStatus::kOk);
  }
  static bool is_found(const PairMotion& pair) {
    return pair.motion.ok && agreeing_share(pair.motion, pair.field) > kWellFound;
  }

  std::vector<BallMotion> measure_all(std::span<const PairMotion> pairs) {
    std::vector<BallTask> tasks;
    for (const PairMotion& pair : pairs) {
      tasks.push_back(is_found(pair) ? task_of(pair, pair.motion) : task_of(pair, guess_of(pair)));
    }
    std::vector<BallMotion> motions = sphere_.measure(frames_, tasks);
    std::vector<ShapedPair> shaped;
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      if (!pairs[i].near_contact) continue;
      shaped.push_back({tasks[i],
                        &motions[i],
                        {as_small_as(pairs[i].first.r_px, pairs[i].shape),
                         as_small_as(pairs[i].second.r_px, pairs[i].second_shape)}});
    }
    doubt_shapes(sphere_, frames_, shaped);
    return motions;
  }

  // Of two outlines one of which hides that the ball is pressed the other tells the shape: from a
  // frame to the next it changes by a part of itself.
  void share_shape(PairMotion& pair) const {
    constexpr double kChange = 0.15;
    const BallShape first = as_small_as(pair.first.r_px, pair.shape);
    const BallShape second = as_small_as(pair.second.r_px, pair.second_shape);
    const auto take = [&](const Circle& known, BallShape shape, Circle& circle, BallShape& hidden) {
      const double change = kChange * std::hypot(shape.e1, shape.e2);
      shape.sd = std::hypot(shape.sd, change);
      shape.size_sd = std::hypot(shape.size_sd, change);
      hidden = shape;
      circle.r_px = known.r_px;
    };
    if (hides_shape(first) && second.is_compressed()) {
      take(pair.second, second, pair.first, pair.shape);
    } else if (hides_shape(second) && first.is_compressed()) {
      take(pair.first, first, pair.second, pair.second_shape);
    }
  }

  // A ball that is pressed along one axis is smaller by as much as its ellipse is long: an outline
  // that is smaller and shows none hides it.
  BallShape as_small_as(double r_px, BallShape shape) const {
    const double smaller = 1 - r_px / rim_px_;
    if (!shape.is_circle() || !(smaller > kPressed)) return shape;
    shape.sd = std::hypot(shape.sd, smaller);
    shape.size_sd = std::hypot(shape.size_sd, smaller);
    return shape;
  }

  // Windows and registration once more, from the guess that the search left.
  BallMotion measure_anew(PairMotion& pair) {
    field_->measure({&pair, 1});
    const BallTask task =
        is_found(pair) ? task_of(pair, pair.motion) : task_of(pair, guess_of(pair));
    return sphere_.measure(frames_, {&task, 1})[0];
  }

  // Looks for the turn without any guess. Where one stands out it becomes the pair's guess and its
  // motion.
  bool search(PairMotion& pair) {
    std::vector<BallTask> tasks;
    for (const dic::SphereTurn& candidate : search_.find(frames_, search_task(pair, radius_px_))) {
      dic::RigidMotion start = guess_of(pair);
      const Eigen::Vector3d turn =
          dic::rotation_vector({candidate.w, candidate.x, candidate.y, candidate.z});
      start.rot_x_rad = turn.x();
      start.rot_y_rad = turn.y();
      start.rot_rad = turn.z();
      tasks.push_back(task_of(pair, start));
    }
    const std::vector<BallMotion> motions = sphere_.measure(frames_, tasks);
    const BallMotion* best = nullptr;
    for (const BallMotion& motion : motions) {
      if (is_ok(motion) && (best == nullptr || motion.correlation > best->correlation)) {
        best = &motion;
      }
    }
    if (best == nullptr) return false;
    take_over(*best, pair);
    pair.sought = true;
    pair.guess_rot_x_rad = best->rot_x_rad;
    pair.guess_rot_y_rad = best->rot_y_rad;
    pair.guess_rot_rad = best->rot_rad;
    return true;
  }

  static dic::RigidMotion guess_of(const PairMotion& pair) {
    dic::RigidMotion guess;
    guess.dx_px = pair.second.cx_px - pair.first.cx_px;
    guess.dy_px = pair.second.cy_px - pair.first.cy_px;
    guess.rot_x_rad = pair.guess_rot_x_rad;
    guess.rot_y_rad = pair.guess_rot_y_rad;
    guess.rot_rad = pair.guess_rot_rad;
    return guess;
  }

  BallTask task_of(const PairMotion& pair, const dic::RigidMotion& start) const {
    BallTask task = sphere_task(pair.first, radius_px_, blur_px2_, start);
    task.light = light_;
    task.first = pair.first_slot;
    task.second = pair.second_slot;
    task.sight = pair_sight(pair, perspective_, rim_px_);
    return task;
  }

  void take_over(const BallMotion& ball, PairMotion& pair) const {
    const int used = pair.motion.used;
    dic::SphereSource source;
    source.radius_sd_px = radius_sd_px_;
    source.nearness_sd = perspective_.nearness_sd;
    source.light = light_;
    const double x_px = pair.first.cx_px, y_px = pair.first.cy_px;
    source.aside_px = perspective_.aside_px(x_px + pair.first_left_px, y_px + pair.first_top_px);
    source.later_aside_px = perspective_.aside_px(x_px + ball.dx + pair.second_left_px,
                                                  y_px + ball.dy + pair.second_top_px);
    pair.motion = sphere_motion(ball, source);
    pair.motion.used = used;
    pair.status = TrackStatus::kOk;
  }

  double radius_px_, radius_sd_px_, rim_px_, blur_px2_;
  BallLight light_;
  Perspective perspective_;
  std::unique_ptr<MotionEstimator> field_;
  dic::DeviceFrames& frames_;
  dic::BallRegistration sphere_;
  dic::SphereSearch search_;
};

}  // namespace

SphereSearchTask search_task(const PairMotion& pair, double radius_px) {
  return {pair.first_slot,
          pair.second_slot,
          static_cast<float>(pair.first.cx_px),
          static_cast<float>(pair.first.cy_px),
          static_cast<float>(pair.second.cx_px),
          static_cast<float>(pair.second.cy_px),
          static_cast<float>(radius_px)};
}

BallTask sphere_task(const Circle& circle, double radius_px, double blur_px2,
                     const dic::RigidMotion& start) {
  BallTask task{};
  task.cx = static_cast<float>(circle.cx_px);
  task.cy = static_cast<float>(circle.cy_px);
  task.radius = static_cast<float>(radius_px - dic::kRimMarginPx);
  task.ball_radius = static_cast<float>(radius_px);
  task.blur = static_cast<float>(blur_px2);
  task.guess_dx = static_cast<float>(start.dx_px);
  task.guess_dy = static_cast<float>(start.dy_px);
  task.guess_rot_x_rad = static_cast<float>(start.rot_x_rad);
  task.guess_rot_y_rad = static_cast<float>(start.rot_y_rad);
  task.guess_rot_rad = static_cast<float>(start.rot_rad);
  return task;
}

BallSight pair_sight(const PairMotion& pair, const Perspective& perspective, double rim_px) {
  SeenBall first{pair.first, pair.shape};
  first.circle.cx_px += pair.first_left_px;
  first.circle.cy_px += pair.first_top_px;
  return sight_of(perspective, rim_px, first, {pair.second, pair.second_shape},
                  pair.first.cx_px + pair.second_left_px, pair.first.cy_px + pair.second_top_px);
}

dic::RigidMotion sphere_motion(const BallMotion& ball, dic::SphereSource source) {
  // The lower triangle of dx, dy and the turns about X, Y and Z.
  const float* covariance = ball.covariance;
  dic::RigidMotion motion;
  motion.ok = true;
  motion.dx_px = ball.dx;
  motion.dy_px = ball.dy;
  motion.rot_x_rad = ball.rot_x_rad;
  motion.rot_y_rad = ball.rot_y_rad;
  motion.rot_rad = ball.rot_rad;
  motion.rot_sd_rad = std::sqrt(covariance[14]);
  motion.dx_sd_px = std::sqrt(covariance[0]);
  motion.dy_sd_px = std::sqrt(covariance[2]);
  motion.rot_x_sd_rad = std::sqrt(covariance[5]);
  motion.rot_y_sd_rad = std::sqrt(covariance[9]);
  motion.dy_rot_x_corr = covariance[4] / (motion.dy_sd_px * motion.rot_x_sd_rad);
  motion.dx_rot_y_corr = covariance[6] / (motion.dx_sd_px * motion.rot_y_sd_rad);
  source.radius_px = ball.ball_radius;
  if (source.radius_sd_px > 0 || source.nearness_sd > 0) dic::add_source_errors(motion, source);
  return motion;
}

std::unique_ptr<MotionEstimator> make_sphere_estimator(opencl::Engine& engine,
                                                       const EstimatorOptions& options,
                                                       double radius_px,
                                                       dic::DeviceFrames& frames) {
  return std::make_unique<SphereEstimator>(engine, options, radius_px, frames);
}

}  // namespace impactdic::motion
