// Pairs of rendered frames whose motion is known exactly: measured by an estimator of `track`, held
// against the truth and against the Cramér–Rao bound.
#pragma once

#include <impactdic/units.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "host/circle/circle.h"
#include "host/dic/frames/device_frames.h"
#include "host/motion/motion_estimator.h"
#include "sim/speckle/render.h"
#include "tests/support/engine.h"

namespace impactdic::testing {

// Root mean square and mean of a sample, and of the sample over its stated deviations and over the
// bound.
struct Errors {
  double sum = 0, squares = 0, over_sd_sq = 0, over_bound_sq = 0, largest = 0;
  int count = 0;
  void add(double error, double sd, double bound = kNotMeasured) {
    sum += error;
    squares += error * error;
    over_sd_sq += error * error / (sd * sd);
    over_bound_sq += error * error / (bound * bound);
    largest = std::max(largest, std::abs(error));
    ++count;
  }
  void add(const Errors& other) {
    sum += other.sum;
    squares += other.squares;
    over_sd_sq += other.over_sd_sq;
    over_bound_sq += other.over_bound_sq;
    largest = std::max(largest, other.largest);
    count += other.count;
  }
  double mean() const { return sum / count; }
  double rms() const { return std::sqrt(squares / count); }
  double over_sd() const { return std::sqrt(over_sd_sq / count); }
  double over_bound() const { return std::sqrt(over_bound_sq / count); }
};

// Of measured circles.
struct CircleErrors {
  Errors centre, radius;
  int failed = 0;
  void add(const circle::CircleFit& fit, const BallPose& pose, double radius_px) {
    if (fit.status != circle::CircleStatus::kOk) {
      ++failed;
      return;
    }
    centre.add(fit.circle.cx_px - pose.cx_px, fit.cx_sd_px);
    centre.add(fit.circle.cy_px - pose.cy_px, fit.cy_sd_px);
    radius.add(fit.circle.r_px - radius_px, fit.r_sd_px);
  }
  void add(const CircleErrors& other) {
    centre.add(other.centre);
    radius.add(other.radius);
    failed += other.failed;
  }
};

struct MotionErrors {
  Errors x, y, rotation_deg;
  int failed = 0;
  void add(const MotionErrors& other) {
    x.add(other.x);
    y.add(other.y);
    rotation_deg.add(other.rotation_deg);
    failed += other.failed;
  }
  double rms_px() const { return std::sqrt((x.squares + y.squares) / (x.count + y.count)); }
  double over_sd() const { return pooled(&Errors::over_sd_sq); }
  double over_bound() const { return pooled(&Errors::over_bound_sq); }
  void print(const std::string& name) const {
    std::printf(
        "%-28s %5d pairs, %d failed: rms %.5f %.5f px %.5f deg; mean %+.5f %+.5f %+.5f; worst %.4f "
        "%.4f %.4f; over sd %.2f %.2f %.2f; over bound %.2f %.2f %.2f\n",
        name.c_str(), x.count, failed, x.rms(), y.rms(), rotation_deg.rms(), x.mean(), y.mean(),
        rotation_deg.mean(), x.largest, y.largest, rotation_deg.largest, x.over_sd(), y.over_sd(),
        rotation_deg.over_sd(), x.over_bound(), y.over_bound(), rotation_deg.over_bound());
    std::fflush(stdout);
  }

 private:
  double pooled(double Errors::*squares) const {
    return std::sqrt((x.*squares + y.*squares + rotation_deg.*squares) /
                     (x.count + y.count + rotation_deg.count));
  }
};

// The smallest standard deviations that any unbiased estimator of dx, dy and the rotation can have
// from two frames with this noise (and rounding), offset and gain unknown, from the pixels that lie
// `margin_px` within the rim: (JᵀJ)⁻¹ · 2σ², J from differences of exact pictures.
struct MotionBound {
  double x_px = 0, y_px = 0, rotation_deg = 0;
};
inline MotionBound motion_bound(const sim::speckle::SpeckleBall& ball, const SynthScene& scene,
                                double margin_px) {
  const sim::speckle::BallRenderer renderer(ball, scene);
  const BallPose at{0.5 * scene.width, 0.5 * scene.height, 0};
  const auto slope = [&](double dx, double dy, double turn_deg) {
    BallPose more = at, less = at;
    more.cx_px += dx;
    less.cx_px -= dx;
    more.cy_px += dy;
    less.cy_px -= dy;
    more.angle_deg += turn_deg;
    less.angle_deg -= turn_deg;
    Image<double> a = renderer.exact(more);
    const Image<double> b = renderer.exact(less);
    for (std::size_t i = 0; i < a.size(); ++i) a.data()[i] -= b.data()[i];
    return a;
  };
  constexpr double kStep = 0.05;
  const Image<double> level = renderer.exact(at);
  const Image<double> x = slope(kStep, 0, 0), y = slope(0, kStep, 0), turn = slope(0, 0, kStep);
  Eigen::Matrix<double, 5, 5> information = Eigen::Matrix<double, 5, 5>::Zero();
  const double radius = ball.radius_px - margin_px;
  for (int v = 0; v < scene.height; ++v) {
    for (int u = 0; u < scene.width; ++u) {
      if (std::hypot(u - at.cx_px, v - at.cy_px) >= radius) continue;
      Eigen::Matrix<double, 5, 1> j;
      j << x(u, v) / (2 * kStep), y(u, v) / (2 * kStep), turn(u, v) / (2 * kStep), 1, level(u, v);
      information += j * j.transpose();
    }
  }
  const double variance = 2 * (scene.noise_sigma * scene.noise_sigma + 1.0 / 12);
  const Eigen::Matrix<double, 5, 5> covariance = variance * information.inverse();
  return {std::sqrt(covariance(0, 0)), std::sqrt(covariance(1, 1)), std::sqrt(covariance(2, 2))};
}

// Where the estimator is told that the ball is.
enum class Centres {
  kKnown,     // the truth
  kMeasured,  // by our own circle, each frame by itself with the radius known to 0.01 px
};

// Pose 2k is the first frame of pair k, 2k + 1 the second.
struct PosePairs {
  std::vector<BallPose> poses;
  void add(const BallPose& first, const BallPose& second) {
    poses.push_back(first);
    poses.push_back(second);
  }
  std::size_t count() const { return poses.size() / 2; }
};

// Random places and turns, each moved by (dx, dy) px and turned by `rotation_deg`.
inline PosePairs fixed_motions(int count, double dx, double dy, double rotation_deg, unsigned seed,
                               double middle_px) {
  PosePairs pairs;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> off(-1, 1);
  for (int k = 0; k < count; ++k) {
    BallPose first;
    first.cx_px = middle_px + off(random);
    first.cy_px = middle_px + off(random);
    first.angle_deg = 180 * off(random);
    BallPose second = first;
    second.cx_px += dx;
    second.cy_px += dy;
    second.angle_deg += rotation_deg;
    pairs.add(first, second);
  }
  return pairs;
}

// The same with motions up to ±3 px and ±3°, which fit no grid.
inline PosePairs random_motions(int count, unsigned seed, double middle_px) {
  PosePairs pairs = fixed_motions(count, 0, 0, 0, seed, middle_px);
  std::mt19937 random(seed + 1000);
  std::uniform_real_distribution<double> off(-3, 3);
  for (std::size_t k = 0; k < pairs.count(); ++k) {
    BallPose& second = pairs.poses[2 * k + 1];
    second.cx_px += off(random);
    second.cy_px += off(random);
    second.angle_deg += off(random);
  }
  return pairs;
}

struct MeasuredPairs {
  std::vector<motion::PairMotion> pairs;
  MotionErrors at_point;   // motion of the point that the estimator was given as the centre
  MotionErrors at_centre;  // held against the true centre's motion
};

// Measures pairs of pictures with one estimator of `track`, kept from call to call.
class PairMeasurement {
 public:
  PairMeasurement(Estimator estimator, double radius_px)
      : radius_px_(radius_px), frames_(shared_engine(), kSlots) {
    motion::EstimatorOptions options;
    options.estimator = estimator;
    estimator_ = motion::make_motion_estimator(shared_engine(), options, radius_px, frames_);
  }

  MeasuredPairs measure(const sim::speckle::SpeckleBall& ball, const SynthScene& scene,
                        const PosePairs& truth, Centres centres, const MotionBound& bound) {
    const sim::speckle::BallRenderer renderer(ball, scene);
    MeasuredPairs out;
    for (std::size_t first = 0; first < truth.count(); first += kSlots / 2) {
      const std::size_t count = std::min<std::size_t>(kSlots / 2, truth.count() - first);
      std::vector<motion::PairMotion> pairs(count);
      for (std::size_t k = 0; k < 2 * count; ++k) {
        const std::size_t at = 2 * first + k;
        Frame frame;
        renderer.render(truth.poses[at], static_cast<std::int64_t>(at), frame);
        frames_.set(static_cast<int>(k), frame);
        motion::PairMotion& pair = pairs[k / 2];
        (k % 2 == 0 ? pair.first_slot : pair.second_slot) = static_cast<int>(k);
        (k % 2 == 0 ? pair.first : pair.second) = circle(frame, truth.poses[at], centres);
      }
      estimator_->measure(pairs);
      for (std::size_t k = 0; k < count; ++k) {
        add(pairs[k], truth.poses[2 * (first + k)], truth.poses[2 * (first + k) + 1], bound, out);
      }
      out.pairs.insert(out.pairs.end(), pairs.begin(), pairs.end());
    }
    return out;
  }

 private:
  static constexpr int kSlots = 16;

  Circle circle(const Frame& frame, const BallPose& pose, Centres centres) const {
    if (centres == Centres::kKnown) return {pose.cx_px, pose.cy_px, radius_px_};
    circle::CirclePrior prior;
    prior.predicted = {pose.cx_px + 0.21, pose.cy_px - 0.17, radius_px_ + 0.1};
    prior.centre_sd_px = 0.3;
    prior.rim_sd_px = 0.3;
    prior.radius_px = radius_px_;
    prior.radius_sd_px = 0.01;
    return circle::measure_circle(frame, prior, {}).circle;
  }

  static void add(const motion::PairMotion& pair, const BallPose& a, const BallPose& b,
                  const MotionBound& bound, MeasuredPairs& out) {
    if (!pair.motion.ok) {
      ++out.at_point.failed;
      ++out.at_centre.failed;
      return;
    }
    const dic::RigidMotion& m = pair.motion;
    const double turn_deg = b.angle_deg - a.angle_deg;
    const double c = std::cos(turn_deg * kRadPerDeg) - 1, s = std::sin(turn_deg * kRadPerDeg);
    const double ex = pair.first.cx_px - a.cx_px, ey = pair.first.cy_px - a.cy_px;
    const double dx = b.cx_px - a.cx_px, dy = b.cy_px - a.cy_px;
    const double turn_error = std::remainder(m.rot_rad * kDegPerRad - turn_deg, 360);
    const auto record = [&](MotionErrors& errors, double true_dx, double true_dy) {
      errors.x.add(m.dx_px - true_dx, m.dx_sd_px, bound.x_px);
      errors.y.add(m.dy_px - true_dy, m.dy_sd_px, bound.y_px);
      errors.rotation_deg.add(turn_error, m.rot_sd_rad * kDegPerRad, bound.rotation_deg);
    };
    record(out.at_point, dx + c * ex + s * ey, dy - s * ex + c * ey);
    record(out.at_centre, dx, dy);
  }

  double radius_px_;
  dic::DeviceFrames frames_;
  std::unique_ptr<motion::MotionEstimator> estimator_;
};

}  // namespace impactdic::testing
