// A shot whose scale, lens and tilt are known by a calibration alone: random, as filmed_shot.h
// makes them, framed at random in 400 x 300 px, seen by a camera that lies up to 6 degrees askew
// and has up to 3 % of distortion.
#pragma once

#include <impactdic/error.h>

#include <random>
#include <vector>

#include "host/camera/plane_view.h"
#include "host/run/metres/camera_part.h"
#include "tests/support/camera/rendered_calibration.h"
#include "tests/support/camera/through_lens.h"
#include "tests/support/filmed_shot.h"

namespace impactdic::testing {

// How the camera comes to be known.
struct CalibrationPlan {
  CalibrationTarget target = CalibrationTarget::kCheckerboard;
  int fewest_pictures = 5, most_pictures = 30;
  double pitch_sd = 5e-4;  // of the target's pitch, relative
  // Above 0: the target's points as the camera shows them with this much noise, px, in place of
  // rendered pictures.
  double points_sd_px = 0;
};

struct ShotByTarget {
  FilmedShot shot;  // its rows as the true camera shows them
  Camera camera;    // found
  int refused = 0;  // calibrations that were: other pictures were taken then

  void conclude() { conclude_through(camera, shot); }
};

namespace shot_by_target {

inline FilmedImpact without_noise(FilmedImpact filmed) {
  filmed.step_noise_m_s = filmed.spin_noise_rad_s = filmed.position_noise_px = 0;
  return filmed;
}

// `plain`: rows in the plane without noise. Their noise is added in the camera's picture.
inline std::vector<TrackRow> seen_by(const Camera& camera, const std::vector<TrackRow>& plain,
                                     const std::vector<TrackRow>& noisy, double metre_per_px) {
  std::vector<TrackRow> seen = through_lens(camera, plain, metre_per_px);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    TrackRow& row = seen[i];
    const TrackRow as_seen = row;
    row = noisy[i];
    row.cx_px = as_seen.cx_px + noisy[i].cx_px - plain[i].cx_px;
    row.cy_px = as_seen.cy_px + noisy[i].cy_px - plain[i].cy_px;
    row.r_px = as_seen.r_px + noisy[i].r_px - plain[i].r_px;
    row.dx_px = as_seen.dx_px + noisy[i].dx_px - plain[i].dx_px;
    row.dy_px = as_seen.dy_px + noisy[i].dy_px - plain[i].dy_px;
    row.rot_deg = as_seen.rot_deg + noisy[i].rot_deg - plain[i].rot_deg;
  }
  return seen;
}

inline Camera calibrated(const CalibrationPlan& plan, const CalibrateRequest& request,
                         const std::vector<Camera>& views, unsigned seed) {
  if (plan.points_sd_px == 0) {
    return calibrate_rendered(request, rendered_pictures(request, views, seed)).camera;
  }
  return camera::calibrate_points(request, noisy_views(request, views, plan.points_sd_px, seed),
                                  views[0].width, views[0].height)
      .camera;
}

// The true camera and what its calibration finds, by pictures of a target that is a little larger
// or smaller than told.
struct CameraPair {
  Camera truth, found;
};
inline CameraPair calibrate_at_random(std::mt19937_64& random, const CalibrationPlan& plan,
                                      double metre_per_px) {
  std::uniform_real_distribution<double> part(0, 1);
  std::normal_distribution<double> normal(0, 1);
  const int more = plan.most_pictures - plan.fewest_pictures + 1;
  const int pictures = plan.fewest_pictures + static_cast<int>(more * part(random));
  const auto seed = static_cast<unsigned>(random());
  const double larger = 1 + plan.pitch_sd * normal(random);
  CalibrateRequest request = rendered_target(plan.target);
  const Camera any = random_calibration(request, 1, seed).views[0];
  const double enlarge = metre_per_px / (larger * camera::PlaneView(any).metre_per_px());
  request.pitch_mm *= enlarge, request.dot_mm *= enlarge;
  request.pitch_sd_mm = plan.pitch_sd * request.pitch_mm;
  const std::vector<Camera> views = random_calibration(request, pictures, seed).views;
  CameraPair pair{views[0], calibrated(plan, request, views, static_cast<unsigned>(random()))};
  using P = CameraParameter;
  for (const P along : {P::kPositionX, P::kPositionY, P::kPositionZ}) pair.truth[along] *= larger;
  return pair;
}

// Moves rows in the plane so that what the ball covers lies somewhere in the picture.
inline void frame_at_random(std::mt19937_64& random, const Camera& camera, double metre_per_px,
                            std::vector<TrackRow>& plain, std::vector<TrackRow>& noisy) {
  constexpr double kOfTheMargin = 0.4;  // either way; lens and tilt take some of it
  std::uniform_real_distribution<double> aside(-kOfTheMargin, kOfTheMargin);
  const BallBox box = ball_box(plain);
  const Eigen::Vector2d middle =
      camera::PlaneView(camera).to_plane({(camera.width - 1) / 2.0, (camera.height - 1) / 2.0}) /
      metre_per_px;
  const double x =
      middle.x() + aside(random) * (camera.width - box.width()) - (box.left + box.right) / 2;
  const double y = camera.height - 1 - middle.y() + aside(random) * (camera.height - box.height()) -
                   (box.top + box.bottom) / 2;
  for (std::vector<TrackRow>* rows : {&plain, &noisy}) {
    for (TrackRow& row : *rows) row.cx_px += x, row.cy_px += y;
  }
}

}  // namespace shot_by_target

inline ShotByTarget shot_by_target_of(std::mt19937_64& random, const CalibrationPlan& plan,
                                      const Tolerances& tolerances = {}) {
  using namespace shot_by_target;
  ShotByTarget made;
  FilmedShot& shot = made.shot = filmed_shot(random, ScaleBy::kTarget, tolerances);
  const double scale = shot.filmed.metre_per_px;
  CameraPair cameras;
  for (bool done = false; !done;) {
    try {
      cameras = calibrate_at_random(random, plan, scale);
      done = true;
    } catch (const Error&) {
      ++made.refused;
    }
  }
  std::vector<TrackRow> plain;
  film(without_noise(shot.filmed), plain);
  frame_at_random(random, cameras.truth, scale, plain, shot.result.rows);
  shot.result.rows = seen_by(cameras.truth, plain, shot.result.rows, scale);
  shot.result.scale.image_height = cameras.truth.height;
  made.camera = cameras.found;
  return made;
}

}  // namespace impactdic::testing
