// Shots of a known law with the noise of `track`, and the job that fits a law to them.
#pragma once

#include <impactdic/fit.h>

#include "sim/fit/calibration.h"
#include "tests/support/scratch.h"
#include "tests/support/synthetic_track.h"

namespace impactdic::testing {

// A tennis ball on a racket, k 13385 N/m, b 5.36 N s/m, dropped obliquely; friction 0.1.
inline ImpactJob tennis_shot(double angle_deg, double vt_m_s, double vn_m_s) {
  ImpactJob job;
  job.normal = NormalModel::kLinearSpringDamper;
  job.friction = FrictionModel::kCoulomb;
  job.body = {BodyShape::kHollowSphere, 0.0567, 0.067};
  job.contact.stiffness = 13385;
  job.contact.damping_n_s_per_m = 5.36;
  job.contact.friction_kinetic = 0.1;
  job.surface_angle_deg = angle_deg;
  job.initial.vt_m_s = vt_m_s;
  job.initial.vn_m_s = vn_m_s;
  return job;
}

// Fits `fitted` (its normal law, friction and damping; stiffness, damping and friction free) to a
// shot of `truth`.
inline ShotFit fit_of_shot(const ImpactJob& truth, const ImpactJob& fitted, unsigned seed,
                           bool rivals) {
  ScratchFolder folder;
  SyntheticTrack track{truth};
  track.position_noise_m = 13e-6;  // 0.05 px
  track.stated_sd_m = 13e-6;
  track.motion = true;
  track.motion_noise_m = 1.3e-6;
  track.turn_noise_rad = 3.5e-4;
  track.seed = seed;
  write_track(track, folder / "track.csv");
  FitRequest request;
  request.shots = {{folder / "track.csv", truth.surface_angle_deg}};
  request.impact = fitted;
  request.impact.contact.stiffness = request.impact.contact.damping_n_s_per_m = 0;
  request.parameters = {FitParameter::kStiffness, FitParameter::kDamping};
  if (fitted.friction != FrictionModel::kNone) {
    request.parameters.push_back(FitParameter::kFrictionKinetic);
    request.impact.contact.friction_kinetic = 0;
  }
  request.rivals = rivals;
  request.threads = 1;
  return sim::fit::calibrate(request).shots[0];
}

}  // namespace impactdic::testing
