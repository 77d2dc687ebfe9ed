// Calibration of an impact model on measured tracks (dissertation, sections 3.3.1 and
// 4.2.1, and the sound way: least squares on the trajectory).
//
// World axes: metres, x right, y up, rotation counter-clockwise. Local axes: t along the surface, n
// out of it. A value that was not measured is NaN.
#pragma once

#include <impactdic/control.h>
#include <impactdic/export.h>
#include <impactdic/impact_model.h>
#include <impactdic/measured.h>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace IMPACTDIC_PUBLIC impactdic {

// A flat ball against a keyframe, as BodyPose: where the point is that was the centre in frame
// `origin`, and how far the ball has turned since. NaN where it was not placed.
struct TrackPose {
  double x_m = kNotMeasured, y_m = kNotMeasured, place_sd_m = kNotMeasured;
  double angle_rad = kNotMeasured, angle_sd_rad = kNotMeasured;
  std::int64_t origin = -1, keyframe = -1;
};

// A measured track as a calibration reads it. Uncertainties are one standard deviation. Motion k
// leads from frame k to frame k + 1; every list has one entry a frame.
struct MeasuredTrack {
  std::string file;                             // its name in errors and results
  std::vector<double> time_s;                   // ascending, evenly spaced
  std::vector<double> x_m, y_m, position_sd_m;  // of the centre
  std::vector<double> dx_m, dy_m, motion_sd_m;  // rigid motion of the surface pattern
  std::vector<double> turn_rad, turn_sd_rad;    // rotation of that motion
  std::vector<TrackPose> poses;                 // empty where none are known
  double interval_s = 0;
  double metre_per_px = 0;  // of the pictures; must be given
  // Relative standard deviations of metre_per_px and of the rate (1 / interval_s): errors that all
  // frames have in common.
  double scale_sd = 0, rate_sd = 0;
  // Of the surface, as the track knows it; NaN where it does not.
  double surface_angle_deg = 0;

  // Throws InvalidArgument where lists differ in length, times do not ascend, fewer than 20 centres
  // are known, or interval or scale are not positive.
  void validate() const;
};

// One flight, at the instant where the contact begins or ends.
struct ShotFlight {
  std::size_t first = 0, last = 0;       // frames of the fit
  Measured vt_m_s, vn_m_s, omega_rad_s;  // omega NaN: the track has no rotation
};

// What a track tells of its impact without any model of the contact.
struct MeasuredShot {
  std::string file;
  double surface_angle_deg = 0;
  ShotFlight before, after;
  Measured contact_start_s, contact_end_s, contact_s;
  double t_max_compression_s = 0;  // from the contact's start
  Measured max_deflection_m;
  double touch_x_m = 0, touch_y_m = 0;  // the centre at the first touch, world axes
  double noise_m = 0;                   // of one centre, one coordinate
  Measured restitution;
  // Eq. 3.12, with gravity, rolling cap; positive where friction opposes the slip.
  EffectiveFriction friction;
  double friction_sd = 0;
  // The normal position where both flights, carried on, cross, above the lowest one measured. With
  // the restitution it fixes a law's time scale, and needs no sight of the instant of touch.
  Measured crossing_above_lowest_m;
  double crossing_s = 0;  // when they cross, on the track's clock
};

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
  kScale,         // true length over measured length
  kRate,          // true interval between frames over the measured one
  kDrag,          // of the air, shared by all shots: AirForces
  kLift,
  kShellStiffness,  // of the laws, too: BallShell
  kShellDamping,
  kFlatFraction
};
inline constexpr FitParameter kLastFitParameter = FitParameter::kFlatFraction;

// The key as it stands in a job, with its unit; the stiffness's depends on the law.
std::string key_of(FitParameter parameter, NormalModel normal);

// A track.csv of `track`, or a track in memory.
struct FitShot {
  std::filesystem::path track;
  double surface_angle_deg = kNotMeasured;  // NaN: as the track's own local axes have it
  std::optional<MeasuredTrack> in_memory;   // then `track` is not read
};

// Chapter 3's grid.
struct FitGrid {
  double stiffness_max = 30000, damping_max_n_s_per_m = 20;
  int stiffness_steps = 30, damping_steps = 20;
};

struct FitRequest {
  std::vector<FitShot> shots;
  // Laws, body, gravity; its contact holds what is not fitted. Surface angle and initial motion are
  // those of each shot.
  ImpactJob impact;
  FitMethod method = FitMethod::kTrajectory;
  std::vector<FitParameter> parameters;                            // of the laws
  std::vector<FitParameter> unknowns{FitParameter::kContactTime};  // of each measurement
  FitGrid grid;
  int flight_frames = 100;  // the longest flight used on each side
  // In place of what the tracks know of themselves; NaN: as they do.
  double scale_sd = kNotMeasured, rate_sd = kNotMeasured;
  // A shot whose parameter lies farther from the median than so many robust standard deviations is
  // named as an outlier.
  double outlier_sd = 3.5;
  // kTrajectory: also fits rival laws to every shot and ranks them (ShotFit::rivals).
  bool rivals = false;
  int threads = 0;  // shots at a time; 0: as many as the machine has cores

  // Throws InvalidArgument naming the key, as it stands in a job file. What is not fitted must be
  // given, and be possible.
  void validate() const;
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
  // What an error of the scale, and of the rate, of one deviation does to the value. `sd` and the
  // interval hold both.
  double scale_part = 0, rate_part = 0;
};

// One measurement against the fitted model, in the order of time within each series.
struct FitResidual {
  enum class Series { kX, kY, kDx, kDy, kTurn };  // centre, motion of the surface, rotation
  Series series{};
  double time_s = 0;
  double residual = 0, sd = 0;  // model - measured, and the stated deviation: m, or rad of kTurn
};

// A figure of the fitted impact itself, such as its restitution.
struct DerivedFigure {
  std::string key;
  double value = 0, sd = 0;
};

// Whether a model with its fitted parameters describes the data as well as the stated deviations
// ask: the chi square's upper tail (Pearson 1900) is at least 1 %.
enum class Adequacy { kNotTested, kAdequate, kInadequate };

// Another law fitted to the same shot with the same parameters.
struct RivalFit {
  NormalModel normal{};
  FrictionModel friction{};
  RestitutionDamping restitution_damping{};
  bool shell = false;  // the ball is one
  double chi_square = 0, p_value = 0;
  double aicc = 0;                            // Hurvich and Tsai 1989
  double above_best = 0;                      // aicc over that of the best of all
  std::vector<ParameterEstimate> parameters;  // of the laws; value only
};

struct ShotFit {
  // As measured without a model; of restitution_duration with the times and velocities that the
  // laws give it, from which its parameters follow.
  MeasuredShot shot;
  std::vector<ParameterEstimate> parameters;  // laws, then unknowns
  std::vector<DerivedFigure> derived;         // trajectory only
  std::vector<double> covariance;             // of them, row-major; NaN where not determined
  double chi_square = 0;
  long measurements = 0, free_parameters = 0;
  double reduced_chi_square = 0;  // by the deviations that the track states
  double aic = 0;                 // chi square + 2 x free parameters
  double p_value = 0;             // of the chi square; NaN where nothing is left to test
  // The parameters' intervals are widened by the misfit where the model is inadequate; they then
  // say how well the data fix the numbers of a wrong law.
  Adequacy adequacy = Adequacy::kNotTested;
  // The request's own laws and their rivals, the best first; empty where none were asked for.
  std::vector<RivalFit> rivals;
  // By what the stated deviations of centres, motions and rotations were multiplied, because their
  // errors are larger or last longer than stated; empty for methods that do not weigh.
  std::vector<double> deviation_factors;
  double rms_m = 0;                    // of the centre's path, both coordinates
  std::vector<FitResidual> residuals;  // trajectory only
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

// How a parameter changes over the shots with what differs between them: weighted least squares.
struct ParameterTrend {
  std::string over;          // speed_m_s or incidence_deg, before the impact
  double slope = 0, sd = 0;  // of the parameter, per unit
  double p_value = 1;        // of no trend (Student)
};

// A parameter over several shots: value_i = value + scatter between the shots + the shot's own
// error (random effects).
struct PooledEstimate {
  std::string key;
  double mean = 0, scatter_sd = 0;  // over the shots, each counting alike (the published way)
  // Weighted by each shot's own variance and that between the shots. The interval is of Hartung and
  // Knapp (2001), never narrower than the deviations allow. Errors of scale and rate do not average
  // out: all shots are taken to have them in common.
  double value = 0, sd = 0;
  double ci95_low = 0, ci95_high = 0;
  // The deviation between the shots beyond their own errors, by restricted maximum likelihood
  // (Patterson and Thompson 1971); its interval by the generalised Q statistic (Viechtbauer 2007).
  // NaN of one shot.
  double between_sd = 0, between_ci95_low = 0, between_ci95_high = 0;
  double chi_square =
      0;  // of the shots about their weighted mean; about shots - 1 where they agree
  bool determined = false;
  std::vector<std::string> outliers;  // files
  std::vector<ParameterTrend> trends;
  std::vector<std::string> warnings;  // a trend: one value does not hold for all shots
};

struct FitResult {
  std::vector<ShotFit> shots;          // in the request's order; of a cancelled run those done
  std::vector<ErrorSurface> surfaces;  // one a shot; published_grid only
  std::vector<PooledEstimate> pooled;  // of the laws' parameters
  bool cancelled = false;
};

// Fits every shot. Throws FileError or FormatError naming the file, InvalidArgument naming the key.
// Of several shots that fail, the error is the first one's in the request's order.
FitResult fit(const FitRequest& request, const RunControl& control = {});

}  // namespace impactdic
