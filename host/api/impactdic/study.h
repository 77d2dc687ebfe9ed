// The speckle study of the dissertation's section 2.3: painted balls, motions that are
// exactly known, and the errors with which estimators measure them; and figures 2.1 and 2.2: time
// and error against the number of spline points between pixels.
//
// Image axes as in synth.h; errors are measured minus true. NaN: nothing was measured.
#pragma once

#include <impactdic/control.h>
#include <impactdic/device.h>
#include <impactdic/export.h>
#include <impactdic/image.h>
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace IMPACTDIC_PUBLIC impactdic {

// Motion from frame to frame: px, image axes; rotation counter-clockwise on screen.
struct StudyMotion {
  const char* name;
  double dx_px, dy_px, rot_deg;
  bool in_source;  // one of the four of section 2.3
};

// Running sums of one error.
class ErrorSums {
 public:
  void add(double error) {
    ++count_;
    sum_ += error;
    magnitudes_ += std::abs(error);
    squares_ += error * error;
  }
  int count() const { return count_; }
  // NaN where nothing was added.
  double mean() const { return sum_ / count_; }
  double mean_abs() const { return magnitudes_ / count_; }
  double rms() const { return std::sqrt(squares_ / count_); }
  double sd() const { return std::sqrt(std::max(0.0, squares_ / count_ - mean() * mean())); }

 private:
  int count_ = 0;
  double sum_ = 0, magnitudes_ = 0, squares_ = 0;
};

// The errors of one estimator on one clip.
struct MotionErrors {
  int pairs = 0, failed_pairs = 0;
  // Of what `track` would state: the motion of the measured centre against the true centre's.
  ErrorSums dx_px, dy_px, rot_deg;
  // Of the estimator alone, both axes: its motion taken to the true centre.
  ErrorSums shift_px;
  // Both axes, and the bound of the same windows: those found right, whole on the ball, in which
  // there is something to be found (bound up to 0.1 px).
  ErrorSums window_px, window_bound_px;
  // Of all windows: those refused, and those called right although they are wrong.
  int windows = 0, no_texture = 0, failed = 0, wrong = 0;
  double seconds = 0;
};

// The device that a study ran on.
struct StudyDevice {
  std::string name, platform, driver;
  std::size_t count = 0;  // that `device` stands for; the study takes the first
};

struct PatternStudyRequest {
  std::vector<std::string> patterns;  // empty: all sixteen
  // published (or published0 ... published9), zncc, icgn3, icgn5, icgn7, ring, ball.
  std::vector<std::string> estimators = {"published", "zncc", "icgn3", "icgn5",
                                         "icgn7",     "ring", "ball"};
  double noise = 2;  // grey levels of 255
  std::uint64_t seed = 1;
  double radius_px = 115;
  int pairs = 4;  // of frames for each motion
  // Throws InvalidArgument naming the setting, by its name on the command line.
  void validate() const;
};

// One pattern, motion and estimator.
struct PatternStudyRow {
  std::string pattern, estimator;
  double density = 0;  // of the pattern
  StudyMotion motion{};
  MotionErrors errors;
  ErrorSums centre_px;  // of the measured circle, both axes
  // The least deviation of the ball's motion that noise allows, from all its pixels.
  double bound_dx_px = 0, bound_dy_px = 0, bound_rot_deg = 0;
};

// What one estimator makes of one or several patterns, all motions pooled.
struct PooledErrors {
  std::string estimator;
  int pairs = 0, failed_pairs = 0;
  double motion_rms_px = 0, rot_rms_deg = 0;  // as `track` would state them; per axis
  double shift_rms_px = 0;                    // of the estimator alone
  double surface_rms_px = 0;                  // of a point anywhere on the ball, per axis
  double window_rms_px = 0, window_bound_px = 0, no_texture_share = 0, wrong_share = 0;
  double bound_px = 0, bound_deg = 0;
};

// One estimator over all patterns, by group of patterns ("a" ... "f") and by pattern.
struct EstimatorErrors {
  std::string estimator;
  PooledErrors all;
  std::vector<std::pair<std::string, PooledErrors>> groups, patterns;
};

struct PatternFindings {
  std::vector<EstimatorErrors> estimators;
  std::string best_estimator, best_pattern;
  std::vector<std::string> as_good_patterns;  // within the study's doubt
  std::string finding;                        // which pattern to paint, in a sentence
};

struct PatternStudyResult {
  std::vector<PatternStudyRow> rows;  // of a cancelled run those done
  PatternFindings findings;           // empty where there is no row
  StudyDevice device;
  double seconds = 0;
  bool cancelled = false;
};

// As `track` does, circles are measured in every frame, the first pair of a clip starts without
// knowing the rotation, the others know the first one's. Throws InvalidArgument, OpenClError,
// BuildError.
PatternStudyResult study_patterns(const PatternStudyRequest& request, Session& session,
                                  const RunControl& control = {});

struct DensityStudyRequest {
  std::string pattern = "e1";
  double dx_px = 0.37, dy_px = -0.61;  // on no grid of 1/(N + 1) px
  double noise = 2;                    // grey levels of 255
  double radius_px = 115;
  std::uint64_t seed = 1;
  int windows = 48;     // measured one by one by the literal method
  int repeats = 3;      // the shortest time counts
  int most_points = 9;  // N = 0 ... this
  int window_px = 15;
  // Throws InvalidArgument naming the setting, by its name on the command line.
  void validate() const;
};

// One method at one N.
struct DensityRow {
  int points = 0;
  std::string method;        // literal, published, icgn
  double us_per_window = 0;  // on the host's one core (literal), on the device (the others)
  double rms_px = 0, bias_x_px = 0, bias_y_px = 0;
  double same_lag_share = 0;  // windows that give the literal method's answer; NaN for icgn
};

struct DensityFindings {
  double same_lag_share = 0;      // the least of all N
  double default_spread = 0;      // largest over smallest time of the default method
  double literal_slowdown = 0;    // most points over none
  double published_slowdown = 0;  // the same by our route
  // Slope of ln(time) against ln(M^2 ln M), M = samples a side: 1 where the literal method costs
  // what its transforms cost. Needs three values of N.
  std::optional<double> literal_growth;
  std::string finding;  // in a sentence
};

struct DensityStudyResult {
  std::vector<DensityRow> rows;  // of a cancelled run those done
  // A window of the first frame, as in Fig. 2.1: (window, window), and the same with 5 points
  // between pixels.
  Image<double> window, interpolated;
  DensityFindings findings;  // empty where there is no row
  StudyDevice device;
  bool cancelled = false;
};

// The published method as it is described, the same by our route, and the default method, which has
// no spline points. Throws InvalidArgument, OpenClError, BuildError.
DensityStudyResult study_density(const DensityStudyRequest& request, Session& session,
                                 const RunControl& control = {});

}  // namespace impactdic
