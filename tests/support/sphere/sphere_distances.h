// How well two pictures of a sphere tell from where it is seen, its circle known as well as in a
// clip: what the tests and the bench share.
#pragma once

#include <string>

#include "tests/support/sphere/sphere_pairs.h"

namespace impactdic::testing {

// Pairs whose ball turns by `turn_deg` about random axes, and how they are seen and lit.
struct DistanceView {
  double distance_radii = 25;  // 0: parallel rays
  double turn_deg = 25;
  double noise = 2;
  std::string pattern = "e1";
  double lamp_share = 0, limb_darkening = 0;
  double tilt_deg = 90;  // of the turn's axis from the line of sight, at least
};

struct DistancesFound {
  int lost = 0;
  double mean_error = 0;  // of the radius over the distance
  Errors nearness;        // the same, rms
  Errors radius_px;
};

// As a circle misplaces its ball.
inline void misplace(BallTask& task, std::mt19937& random) {
  task.centre_sd = 0.02F;
  std::normal_distribution<float> off(0, task.centre_sd);
  task.cx += off(random);
  task.cy += off(random);
}

inline DistancesFound measure_distances(int count, const DistanceView& view, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> off(-1, 1);
  SynthScene scene;
  scene.distance_radii = view.distance_radii;
  scene.lamp_share = view.lamp_share;
  scene.lamp_elevation_deg = 30;
  scene.limb_darkening = view.limb_darkening;
  scene.width = scene.height = kSide + 120;
  scene.noise_sigma = view.noise;
  scene.noise_seed = seed;
  const double middle = (scene.width - 1) / 2.0;
  const double truth = view.distance_radii > 0 ? 1 / view.distance_radii : 0;
  const sim::speckle::SphereRenderer sphere(
      sim::speckle::paint_sphere(view.pattern, seed, kRadiusPx), scene);
  dic::BallOptions options;
  options.model = dic::BallModel::kSphereRadiusAndDistance;
  options.free_centre = true;
  dic::DeviceFrames frames(shared_engine(), 2);
  dic::BallRegistration registration(shared_engine(), options);
  DistancesFound found;
  for (int k = 0; k < count; ++k) {
    const SpherePose first{middle + 60 * off(random), middle + 60 * off(random),
                           dic::quaternion_of(3 * random_axis(random))};
    Eigen::Vector3d axis = random_axis(random);
    axis.z() *= std::cos(view.tilt_deg * kRadPerDeg);
    const Eigen::Vector3d turn = axis.normalized() * view.turn_deg * kRadPerDeg;
    const SpherePose second{first.cx_px + 1.5 * off(random), first.cy_px + 1.5 * off(random),
                            dic::quaternion_of(turn) * first.turn};
    Frame pictures[2];
    const SpherePose* poses[] = {&first, &second};
    for (int i : {0, 1}) {
      BallPose at{poses[i]->cx_px, poses[i]->cy_px};
      sim::speckle::set_orientation(at, poses[i]->turn);
      sphere.render(at, 2 * k + i, pictures[i]);
      frames.set(i, pictures[i]);
    }
    BallTask task = task_near(first, second, turn, random);
    misplace(task, random);
    task.ball_radius += static_cast<float>(0.3 * off(random));
    task.sight = sight_between(first, second, {0.02 / kRadiusPx, middle, middle});
    const BallMotion got = registration.measure(frames, {&task, 1})[0];
    if (got.status != static_cast<idic_int>(WindowStatus::kOk)) {
      ++found.lost;
      continue;
    }
    const double error = got.by_distance * kRadiusPx - truth;
    found.mean_error += error / count;
    found.nearness.add(error, got.by_distance_sd * kRadiusPx);
    found.radius_px.add(got.ball_radius - kRadiusPx, got.ball_radius_sd);
  }
  std::printf(
      "%s seen from %g radii, turned by %g deg, noise %g, lamp %g, limb %g: R/D off by %.5f on the "
      "mean, %.5f rms, %.2f of stated; R %.3f px, %.2f of stated; %d lost\n",
      view.pattern.c_str(), view.distance_radii, view.turn_deg, view.noise, view.lamp_share,
      view.limb_darkening, found.mean_error, found.nearness.rms(), found.nearness.rms_over_sd(),
      found.radius_px.rms(), found.radius_px.rms_over_sd(), found.lost);
  return found;
}

}  // namespace impactdic::testing
