// A tennis ball on a racket at 15 degrees, the law as in sim/jobs/racket_15.toml.
#pragma once

#include <impactdic/impact_model.h>

namespace impactdic::testing {

inline ImpactJob racket_job() {
  ImpactJob job;
  job.body = {BodyShape::kHollowSphere, 0.0567, 0.067};
  job.contact.stiffness = 13385;
  job.contact.damping_n_s_per_m = 5.36;
  job.contact.friction_kinetic = 0.0335;
  job.surface_angle_deg = 15;
  job.initial.vt_m_s = -0.5176;
  job.initial.vn_m_s = -1.9319;
  return job;
}

}  // namespace impactdic::testing
