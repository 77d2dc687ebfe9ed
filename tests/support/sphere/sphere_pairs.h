// Pairs of pictures of a sphere, measured: what the accuracy tests and the bench share.
#pragma once

#include <impactdic/units.h>

#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "host/dic/device/ball.h"
#include "host/dic/device/sphere_search.h"
#include "host/motion/perspective.h"
#include "host/sphere/picture_blur.h"
#include "sim/speckle/orientation.h"
#include "sim/speckle/sphere/sphere_render.h"
#include "tests/support/engine.h"
#include "tests/support/sphere/sphere_pictures.h"

namespace impactdic::testing {

inline constexpr int kSide = 300;
inline constexpr double kRadiusPx = 115;

inline Eigen::Vector3d random_axis(std::mt19937& random) {
  std::normal_distribution<double> deviate(0, 1);
  return Eigen::Vector3d(deviate(random), deviate(random), deviate(random)).normalized();
}

// Root mean square error of a figure, and of it over its stated deviation.
struct Errors {
  double squares = 0, normalised = 0;
  int count = 0;
  void add(double error, double sd) {
    squares += error * error;
    normalised += error * error / (sd * sd);
    ++count;
  }
  double rms() const { return std::sqrt(squares / count); }
  double rms_over_sd() const { return std::sqrt(normalised / count); }
};

struct Summary {
  int lost = 0;
  Errors shift, in_depth_deg, about_sight_deg;
};

// How pairs are seen: from so many radii away (0: parallel rays), compressed by so much in the
// second picture and by four fifths of it in the first, and whether the registration is told.
struct PairView {
  double distance_radii = 0, compression = 0;
  bool told = true;
  std::string pattern = "e1";
  std::size_t marks = 0;  // so many of its speckles are left, evenly; 0: all
};

inline sim::speckle::SpeckleSphere painted(const PairView& view, unsigned seed) {
  sim::speckle::SpeckleSphere sphere = sim::speckle::paint_sphere(view.pattern, seed, kRadiusPx);
  if (view.marks == 0) return sphere;
  sphere.strips.clear();
  std::vector<sim::speckle::InkCap> left;
  const std::size_t every = sphere.caps.size() / view.marks;
  for (std::size_t i = 0; i < view.marks; ++i) left.push_back(sphere.caps[i * every]);
  sphere.caps = std::move(left);
  return sphere;
}

// The registration of a pair, started beside the truth.
inline BallTask task_near(const SpherePose& first, const SpherePose& second,
                          const Eigen::Vector3d& turn, std::mt19937& random) {
  std::uniform_real_distribution<double> off(-1, 1);
  BallTask task{};
  task.second = 1;
  task.cx = static_cast<float>(first.cx_px);
  task.cy = static_cast<float>(first.cy_px);
  task.radius = static_cast<float>(kRadiusPx - dic::kRimMarginPx);
  task.ball_radius = static_cast<float>(kRadiusPx);
  task.blur = static_cast<float>(sphere::kUsualBlur_px2);
  task.guess_dx = static_cast<float>(second.cx_px - first.cx_px + 0.05 * off(random));
  task.guess_dy = static_cast<float>(second.cy_px - first.cy_px + 0.05 * off(random));
  task.guess_rot_x_rad = static_cast<float>(turn.x() + 0.01 * off(random));
  task.guess_rot_y_rad = static_cast<float>(turn.y() + 0.01 * off(random));
  task.guess_rot_rad = static_cast<float>(turn.z() + 0.01 * off(random));
  return task;
}

// A compression along y is an ellipse whose mean radius is smaller by half of it.
inline motion::SeenBall seen_ball(const SpherePose& pose) {
  const double mean = 1 - pose.compression / 2;
  motion::SeenBall ball{{pose.cx_px, pose.cy_px, mean * kRadiusPx}, {}};
  ball.shape.e1 = pose.compression / 2 / mean;
  return ball;
}

inline BallSight sight_between(const SpherePose& first, const SpherePose& second,
                               const motion::Perspective& perspective) {
  return motion::sight_of(perspective, kRadiusPx, seen_ball(first), seen_ball(second), first.cx_px,
                          first.cy_px);
}

// `turn`: the true rotation vector from the first pose to the second.
inline void add_errors(const BallMotion& got, const SpherePose& first, const SpherePose& second,
                       const Eigen::Vector3d& turn, Summary& summary) {
  summary.shift.add(got.dx - (second.cx_px - first.cx_px), got.dx_sd);
  summary.shift.add(got.dy - (second.cy_px - first.cy_px), got.dy_sd);
  // The small turn that is left, in the axes of the first picture, as deviations are stated.
  const Eigen::Vector3d found(got.rot_x_rad, got.rot_y_rad, got.rot_rad);
  const Eigen::Vector3d left =
      dic::rotation_vector(dic::quaternion_of(turn).conjugate() * dic::quaternion_of(found));
  summary.in_depth_deg.add(left.x() * kDegPerRad, std::sqrt(got.covariance[5]) * kDegPerRad);
  summary.in_depth_deg.add(left.y() * kDegPerRad, std::sqrt(got.covariance[9]) * kDegPerRad);
  summary.about_sight_deg.add(left.z() * kDegPerRad, got.rot_sd_rad * kDegPerRad);
}

inline void print_errors(double most_deg, double noise, const Summary& summary) {
  std::printf(
      "to %g deg, noise %g: rms %.5f px, %.5f deg in depth, %.5f deg about the line of "
      "sight; over sd %.2f %.2f %.2f\n",
      most_deg, noise, summary.shift.rms(), summary.in_depth_deg.rms(),
      summary.about_sight_deg.rms(), summary.shift.rms_over_sd(),
      summary.in_depth_deg.rms_over_sd(), summary.about_sight_deg.rms_over_sd());
}

// Pairs that fly up to 1.5 px and turn by up to `most_deg` about random axes.
inline Summary measure_pairs(int count, double most_deg, double noise, unsigned seed,
                             const PairView& view = {}) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> off(-1, 1);
  SynthScene scene;
  scene.distance_radii = view.distance_radii;
  // From near by the ball is also beside the optical axis.
  const double beside_px = view.distance_radii > 0 ? 60 : 0;
  scene.width = scene.height = kSide + 2 * static_cast<int>(beside_px);
  const double middle = (scene.width - 1) / 2.0;
  motion::Perspective perspective;
  if (view.distance_radii > 0)
    perspective = {1 / (view.distance_radii * kRadiusPx), middle, middle};
  scene.noise_sigma = noise;
  scene.noise_seed = seed;
  const sim::speckle::SphereRenderer sphere(painted(view, seed), scene);
  const auto render = [&](const SpherePose& pose, std::int64_t index, Frame& frame) {
    BallPose at{pose.cx_px, pose.cy_px};
    at.compression = pose.compression;
    sim::speckle::set_orientation(at, pose.turn);
    sphere.render(at, index, frame);
  };
  dic::BallOptions options;
  options.model = dic::BallModel::kSphere;
  dic::DeviceFrames frames(shared_engine(), 2);
  dic::BallRegistration registration(shared_engine(), options);
  Summary summary;
  for (int k = 0; k < count; ++k) {
    SpherePose first{middle + 0.5 + off(random), middle + 0.5 + off(random),
                     dic::quaternion_of(3 * random_axis(random))};
    if (beside_px > 0) {
      first.cx_px += beside_px * off(random);
      first.cy_px += beside_px * off(random);
    }
    const Eigen::Vector3d turn =
        random_axis(random) * most_deg * std::abs(off(random)) * kRadPerDeg;
    SpherePose second{first.cx_px + 1.5 * off(random), first.cy_px + 1.5 * off(random),
                      dic::quaternion_of(turn) * first.turn};
    first.compression = 0.8 * view.compression;
    second.compression = view.compression;
    Frame pictures[2];
    render(first, 2 * k, pictures[0]);
    render(second, 2 * k + 1, pictures[1]);
    for (int i : {0, 1}) frames.set(i, pictures[i]);
    BallTask task = task_near(first, second, turn, random);
    if (view.told) task.sight = sight_between(first, second, perspective);
    const BallMotion got = registration.measure(frames, {&task, 1})[0];
    if (got.status != static_cast<idic_int>(WindowStatus::kOk)) {
      ++summary.lost;
      continue;
    }
    add_errors(got, first, second, turn, summary);
  }
  print_errors(most_deg, noise, summary);
  return summary;
}

// Of `count` steps by `step_deg` about random axes, how many the search finds among its candidates
// to within the reach of the registration. Steps that hide nearly all of the surface that was seen
// are left out.
inline int count_found(int count, double step_deg, double noise, unsigned seed) {
  constexpr double kBallPx = 60;
  constexpr double kReach_deg = 2.5;
  std::mt19937 random(seed);
  const SpherePictures sphere(seed, kBallPx, 4.5);
  dic::DeviceFrames frames(shared_engine(), 2);
  dic::SphereSearch search(shared_engine());
  int found = 0, first = 0, hidden = 0;
  for (int k = 0; k < count; ++k) {
    const SpherePose one{80.3, 79.6, dic::quaternion_of(3 * random_axis(random))};
    const Eigen::Quaterniond turn = dic::quaternion_of(random_axis(random) * step_deg * kRadPerDeg);
    // How far the point that faces the camera turns away from it.
    if ((turn * Eigen::Vector3d::UnitZ()).z() < std::cos(85 * kRadPerDeg)) {
      ++hidden;
      continue;
    }
    const SpherePose two{81.1, 79.2, turn * one.turn};
    const auto shot = static_cast<unsigned>(2 * k) + 1000 * seed;
    frames.set(0, sphere.render(one, 160, 160, noise, shot));
    frames.set(1, sphere.render(two, 160, 160, noise, shot + 1));
    SphereSearchTask task{0, 1, 80.3F, 79.6F, 81.1F, 79.2F, kBallPx};
    const auto turns = search.find(frames, task);
    for (std::size_t i = 0; i < turns.size(); ++i) {
      if (turn.angularDistance(Eigen::Quaterniond(turns[i].w, turns[i].x, turns[i].y, turns[i].z)) *
              kDegPerRad <
          kReach_deg) {
        ++found;
        first += i == 0;
        break;
      }
    }
  }
  std::printf("%g deg: %d of %d found, %d as the first, %d hidden\n", step_deg, found,
              count - hidden, first, hidden);
  return found + hidden;
}

}  // namespace impactdic::testing
