// Models against measured shots (dissertation, sections 3.3.2 and 4.4), and rod models
// against measured blows (dissertation, chapter 5). Axes as in fit.h.
#pragma once

#include <impactdic/export.h>
#include <impactdic/fit.h>
#include <impactdic/rod_model.h>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace IMPACTDIC_PUBLIC impactdic {

struct KelvinVoigt {
  bool operator==(const KelvinVoigt&) const = default;
};
// A friction law beside the job's normal law; Kelvin and Voigt's normal law beside the job's
// friction; a formula.
using ComparedModel = std::variant<FrictionModel, KelvinVoigt, ReboundModel>;

std::string_view name_of(const ComparedModel& model);
// Throws InvalidArgument.
ComparedModel parse_compared_model(std::string_view name);

// What the formulas need beside the laws.
struct FormulaParameters {
  double restitution = kNotMeasured;  // NaN: as the job's normal law gives it for the shot
  double tangential_restitution = 0;  // of cross (e_x) and walton (beta_0)
};

// Where a model's coefficient of friction comes from: the job, or each shot's own impulse ratio, by
// Eq. 3.12 or with gravity's impulse (the dissertation's way in chapter 3).
enum class FrictionSource { kJob, kEffectivePublished, kEffectiveSound };

struct CompareRequest {
  FitRequest calibration;      // its shots may be none: then the job's own contact is used
  std::vector<FitShot> shots;  // tracks that the models predict
  std::vector<std::filesystem::path> tables;  // and tables of shots (docs/calibration.md)
  std::filesystem::path printed;              // table of what a paper prints; may be empty
  std::vector<ComparedModel> models;
  FormulaParameters formula;
  FrictionSource friction_source = FrictionSource::kJob;
  int threads = 0;  // shots at a time; 0: as many as the machine has cores

  // Throws InvalidArgument naming the key, as it stands in a job file.
  void validate() const;
};

struct ModelPrediction {
  double restitution = 0;
  double vt_m_s = 0, vn_m_s = 0, omega_rad_s = 0;  // after
  double contact_s = 0, t_max_compression_s = 0;   // NaN: a formula has none
  std::vector<ContactPhase> phases;                // none of a formula
  std::optional<ImpactJob> path;                   // that was integrated
};

// What a paper prints for a model and shot, to stand beside what is computed.
struct PrintedFigures {
  std::string shot, model;
  double vt_m_s = 0, vn_m_s = 0, omega_rad_s = 0, restitution = 0;  // NaN: not printed
};

struct ModelOutcome {
  ComparedModel model;
  ModelPrediction prediction;
  PrintedFigures printed;
  double friction_kinetic = 0;                         // that it was run with
  double vt_error = 0, vn_error = 0, omega_error = 0;  // relative to the measured; NaN without one
  // The velocities after, against their measured deviations; NaN where these are not known. AIC is
  // the chi square + 2 x calibrated parameters.
  double final_chi_square = 0, final_aic = 0;
  // Of the centre's path and of all that the track measures; NaN without a path or a track.
  double rms_m = 0, chi_square = 0, aic = 0;
};

struct ComparedShot {
  MeasuredShot shot;
  // That the models begin with: the motion before, at the touch that the law puts, which may be
  // some microseconds from the track's.
  InitialMotion initial;
  std::vector<ModelOutcome> models;
};

// Averages over the shots of one angle (Figs 3.22 and 3.24); sd is their scatter.
struct AngleAverage {
  double surface_angle_deg = 0;
  int shots = 0;
  Measured restitution, friction_published, friction_sound, rolling_cap;
};

struct CompareResult {
  FitResult calibration;
  ImpactJob laws;                   // with the calibrated parameters
  std::vector<ComparedShot> shots;  // in the request's order; of a cancelled run those done
  std::vector<AngleAverage> angles;
  bool cancelled = false;
};

// Calibrates where the request has shots for it (pooled values), then predicts every shot from its
// measured motion before the impact alone. Throws as fit.
CompareResult compare(const CompareRequest& request, const RunControl& control = {});

struct RodCompareRequest {
  std::vector<std::filesystem::path> tables;  // of blows, with rod_angle_deg (docs/calibration.md)
  std::filesystem::path printed;              // may be empty
  std::vector<std::string> models;            // rigid_rod, flexible_rod, stronge
  double energetic_restitution = kNotMeasured;  // of stronge; NaN without it
  RodModel rigid, flexible;                     // motions of the blows are filled in
  int threads = 0;                              // blows at a time; 0: all cores

  // Throws InvalidArgument naming the key, as it stands in a job file.
  void validate() const;
};

struct RodOutcome {
  std::string model;
  double restitution = 0;  // at the contact point
  double vt_m_s = 0, vn_m_s = 0, omega_rad_s = 0;
  int micro_impacts = 0;                                     // 0: a formula
  double start_to_end_s = 0, contact_s = 0, residual_m = 0;  // NaN of a formula
  PrintedFigures printed;
};

struct ComparedBlow {
  std::string file;  // "FILE: NAME"
  double rod_angle_deg = 0;
  ShotFlight before, after;
  double restitution = 0;  // measured at the contact point; NaN without
  std::vector<RodOutcome> models;
};

struct RodCompareResult {
  std::vector<ComparedBlow> blows;  // in the tables' order; of a cancelled run those done
  bool cancelled = false;
};

// Predicts every blow of the tables. Throws FileError, FormatError or InvalidArgument.
RodCompareResult compare(const RodCompareRequest& request, const RunControl& control = {});

}  // namespace impactdic
