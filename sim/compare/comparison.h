// Models against measured shots (source sections 3.3.2 and 4.4).
#pragma once

#include <impactdic/units.h>

#include <filesystem>
#include <string>
#include <vector>

#include "sim/compare/compared_model.h"
#include "sim/fit/calibration.h"
#include "sim/shot/shot_table.h"

namespace impactdic::sim::compare {

// Where a model's coefficient of friction comes from: the job, or each shot's own impulse ratio, by
// Eq. 3.12 or with gravity's impulse (the source's way in chapter 3).
enum class FrictionSource { kJob, kEffectivePublished, kEffectiveSound };

struct CompareJob {
  fit::FitJob calibration;          // its shots may be none: then the job's own contact is used
  std::vector<fit::FitShot> shots;  // tracks that the models predict
  std::vector<std::filesystem::path> tables;  // and tables of shots (shot_table.h)
  std::filesystem::path printed;              // what a paper prints (shot_table.h); may be empty
  std::vector<ComparedModel> models;
  FormulaParameters formula{kNotMeasured, 0};
  FrictionSource friction_source = FrictionSource::kJob;
};

struct ModelOutcome {
  ComparedModel model;
  ModelPrediction prediction;
  shot::PrintedRow printed;
  double friction_kinetic = 0;                         // that it was run with
  double vt_error = 0, vn_error = 0, omega_error = 0;  // relative to the measured; NaN without one
  // The velocities after, against their measured deviations; NaN where these are not known. AIC is
  // the chi square + 2 x calibrated parameters.
  double final_chi_square = 0, final_aic = 0;
  // Of the centre's path and of all that the track measures; NaN without a path or a track.
  double rms_m = 0, chi_square = 0, aic = 0;
};

struct ComparedShot {
  shot::Shot shot;
  std::vector<ModelOutcome> models;
};

// Averages over the shots of one angle (Figs 3.22 and 3.24).
struct AngleAverage {
  double surface_angle_deg = 0;
  int shots = 0;
  shot::Estimate restitution, friction_published, friction_sound, rolling_cap;
};

struct CompareResult {
  fit::FitResult calibration;
  contact::ImpactJob laws;  // with the calibrated parameters
  std::vector<ComparedShot> shots;
  std::vector<AngleAverage> angles;
};

// Calibrates where the job has shots for it (pooled values), then predicts every shot from its
// measured motion before the impact alone. Throws as calibrate.
CompareResult compare(const CompareJob& job, int threads);

}  // namespace impactdic::sim::compare
