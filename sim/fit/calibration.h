// Calibration of an impact model on measured tracks (source sections 3.3.1 and 4.2.1, and the sound
// way: least squares on the trajectory).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/contact/model.h"
#include "sim/shot/shot.h"

namespace impactdic::sim::fit {

enum class FitMethod { kTrajectory, kPublishedGrid, kRestitutionDuration };

// What can be fitted. The first group are parameters of the laws, shared by all shots; the second
// belong to each shot's measurement.
enum class FitParameter {
  kStiffness,
  kDamping,
  kFrictionKinetic,
  kFrictionStatic,
  kPoisson,
  kYieldStrength,
  kContactTime,   // when the ball touches, on the track's clock
  kSurfaceAngle,  // of the wall
  kScale          // true length over measured length
};

// The key as it stands in a job, with its unit; the stiffness's depends on the law.
std::string key_of(FitParameter parameter, contact::NormalModel normal);

struct FitShot {
  std::filesystem::path track;
  double surface_angle_deg = 0;  // NaN: as the track's own local axes have it
};

// Chapter 3's grid.
struct FitGrid {
  double stiffness_max = 30000, damping_max_n_s_per_m = 20;
  int stiffness_steps = 30, damping_steps = 20;
};

struct FitJob {
  std::vector<FitShot> shots;
  // Laws, body, gravity; its contact holds what is not fitted. Surface angle and initial motion are
  // those of each shot.
  contact::ImpactJob impact;
  FitMethod method = FitMethod::kTrajectory;
  std::vector<FitParameter> parameters;                            // of the laws
  std::vector<FitParameter> unknowns{FitParameter::kContactTime};  // of each measurement
  FitGrid grid;
  int flight_frames = 100;
  // A shot whose parameter lies farther from the median than so many robust standard deviations is
  // named as an outlier.
  double outlier_sd = 3.5;
};

struct ParameterEstimate {
  FitParameter parameter{};
  std::string key;
  double value = 0;
  double sd = 0;                       // NaN: not determined at all
  double ci95_low = 0, ci95_high = 0;  // NaN on a side that is not bounded
  bool determined = false;
  bool profiled = false;  // the interval is of the profile likelihood, not from the covariance
  std::string verdict;    // why it is not determined, and which measurement would determine it
};

// A figure of the fitted impact itself, such as its restitution.
struct DerivedFigure {
  std::string key;
  double value = 0, sd = 0;
};

struct ShotFit {
  // As measured without a model; of restitution_duration with the times and velocities that the
  // laws give it (time_contact), from which its parameters follow.
  shot::Shot shot;
  std::vector<ParameterEstimate> parameters;  // laws, then unknowns
  std::vector<DerivedFigure> derived;         // trajectory only
  std::vector<double> covariance;             // of them, row-major; NaN where not determined
  double chi_square = 0;
  long measurements = 0, free_parameters = 0;
  double reduced_chi_square = 0;  // by the deviations that the track states
  double aic = 0;                 // chi square + 2 x free parameters
  // By what the stated deviations of centres, motions and rotations were multiplied, because their
  // errors are larger or last longer than stated; empty for methods that do not weigh.
  std::vector<double> deviation_factors;
  double rms_m = 0;  // of the centre's path, both coordinates
  bool converged = true;
  std::vector<std::string> warnings;
};

// Errors of chapter 3 on the grid, stiffness slowest.
struct ErrorSurface {
  std::vector<double> stiffness, damping_n_s_per_m;
  std::vector<double> displacement, velocity;       // E_d, E_v
  double grid_stiffness = 0, grid_damping = 0;      // the least node of E_d + E_v
  double spline_stiffness = 0, spline_damping = 0;  // the minimum of the spline through E_d + E_v
  // The spline ten times finer, stiffness slowest (Fig. 3.29).
  std::vector<double> fine_stiffness, fine_damping, fine_sum;
};

struct PooledEstimate {
  std::string key;
  double mean = 0, scatter_sd = 0;  // over the shots, each counting alike (the published way)
  double value = 0, sd = 0;         // weighted by each shot's own covariance
  double chi_square = 0;            // of the shots about `value`; about shots - 1 where they agree
  bool determined = false;
  std::vector<std::string> outliers;  // files
};

struct FitResult {
  std::vector<ShotFit> shots;
  std::vector<ErrorSurface> surfaces;  // one a shot; published_grid only
  std::vector<PooledEstimate> pooled;  // of the laws' parameters
};

// Sharpens when and where a measured contact begins, and how long it lasts, by the shape that the
// spring of `laws` gives to the path (restitution_duration.h); other laws leave the shot as it is.
void time_contact(shot::Shot& shot, const contact::ImpactJob& laws);

// A track and what it measures: without a model, as `track` has it, and with its contact timed by
// the laws, which is what they are fitted and compared with. Throws as calibrate.
struct MeasuredShot {
  shot::Track track;
  shot::Shot shot, timed;
};
MeasuredShot load_shot(const FitShot& source, const contact::ImpactJob& laws, int flight_frames);

// Fits every shot, `threads` at a time (0: as many as the machine has cores). Throws FileError,
// FormatError or InvalidArgument naming file or key.
FitResult calibrate(const FitJob& job, int threads);

// The parameter of the laws in a job: read, write.
double law_parameter(const contact::ImpactJob& job, FitParameter parameter);
void set_law_parameter(contact::ImpactJob& job, FitParameter parameter, double value);
// The job of a measured shot: its surface and the motion before it.
contact::ImpactJob job_of_shot(const contact::ImpactJob& laws, const shot::Shot& shot);

}  // namespace impactdic::sim::fit
