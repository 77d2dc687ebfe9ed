// Models against measured shots (source sections 3.3.2 and 4.4).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/fit/calibration.h"

namespace impactdic {

// Where a model's coefficient of friction comes from: the job, or each shot's own impulse ratio, by
// Eq. 3.12 or with gravity's impulse (the source's way in chapter 3).
enum class FrictionSource { kJob, kEffectivePublished, kEffectiveSound };

struct CompareJob {
  FitJob calibration;          // its shots may be none: then the job's own contact is used
  std::vector<FitShot> shots;  // that the models predict
  std::vector<FrictionModel> models;
  FrictionSource friction_source = FrictionSource::kJob;
};

struct ModelOutcome {
  FrictionModel model{};
  double friction_kinetic = 0;                         // that it was run with
  double vt_m_s = 0, vn_m_s = 0, omega_rad_s = 0;      // after
  double vt_error = 0, vn_error = 0, omega_error = 0;  // relative to the measured; NaN without one
  double contact_s = 0, t_max_compression_s = 0;
  std::vector<Phase> phases;
  double rms_m = 0;  // of the centre's path against the track
  double chi_square = 0, aic = 0;
};

struct ComparedShot {
  Shot shot;
  std::vector<ModelOutcome> models;
};

// Averages over the shots of one angle (Figs 3.22 and 3.24).
struct AngleAverage {
  double surface_angle_deg = 0;
  int shots = 0;
  Estimate restitution, friction_published, friction_sound, rolling_cap;
};

struct CompareResult {
  FitResult calibration;
  ImpactJob laws;  // with the calibrated parameters
  std::vector<ComparedShot> shots;
  std::vector<AngleAverage> angles;
};

// Calibrates where the job has shots for it (pooled values), then predicts every shot from its
// measured motion before the impact alone. Throws as calibrate.
CompareResult compare(const CompareJob& job, int threads);

}  // namespace impactdic
