// A simulated impact seen as a camera would see it: residuals against a track, and their Jacobian.
// Internal to sim/fit.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "sim/fit/calibration.h"
#include "sim/shot/track_table.h"

namespace impactdic::sim::fit {

// One entry of the vector of unknowns. Those without a FitParameter are the motion at the touch.
struct Unknown {
  enum class Kind { kParameter, kTouchX, kTouchY, kTangentialVelocity, kNormalVelocity, kSpin };
  Kind kind = Kind::kParameter;
  FitParameter parameter{};
  double start = 0;
  double step = 0;  // of the differences, and the scale of a change
  double lower = 0, upper = 0;
};

// Measurements whose errors are of one kind, and their order in time.
enum class MeasurementKind { kCentre, kMotion, kTurn, kPrior };
inline constexpr std::size_t kMeasurementKinds = 3;  // of frames; what is known beforehand is none
struct MeasurementSeries {
  MeasurementKind kind{};
  std::size_t axis = 0;  // 0: x or rotation, 1: y; kPrior: the place of the unknown
};
// Factors on the stated standard deviations, at least 1, one a kind of measurement.
using DeviationFactors = std::array<double, kMeasurementKinds>;

class ShotModel {
 public:
  // Compares from the first frame of the flight before to the last of the flight after. A scale or
  // a rate that the track knows only so well is an unknown with that as a measurement of its own.
  ShotModel(const MeasuredTrack& track, const MeasuredShot& shot, const ImpactJob& laws,
            const std::vector<FitParameter>& parameters, const std::vector<FitParameter>& unknowns);

  // Parameters first, then unknowns, then the motion at the touch.
  const std::vector<Unknown>& unknowns() const { return unknowns_; }
  std::size_t size() const { return unknowns_.size(); }
  std::size_t residuals() const { return residuals_; }
  // Residuals over their standard deviations; `jacobian` (residuals x size, row-major) may be null.
  // False where the model has no impact for these values.
  bool evaluate(const double* values, double* residual, double* jacobian) const;
  // Root mean square distance of path and model, per coordinate, m.
  double path_rms_m(const double* values) const;
  ImpactJob impact_of(const double* values) const;
  // The series that residual `row` belongs to; the rows of a series ascend in time.
  MeasurementSeries series_of(std::size_t row) const;
  // Residuals and stated deviations in SI units, series by series.
  std::vector<FitResidual> residuals_at(const double* values) const;
  // Of an unknown that is not among those asked for but known beforehand; size() where it is none.
  std::size_t place_of(FitParameter parameter) const;
  // Weighs the measurements by their stated deviations times these factors. Where residuals in
  // stated deviations are given, one beyond four of its kind's deviations counts less the farther
  // off it is (Huber 1964), so that one misread frame does not bend the path.
  void weigh(const DeviationFactors& factors, std::span<const double> stated_residuals = {});

 private:
  struct Row {
    enum class Kind { kX, kY, kDx, kDy, kTurn, kPrior } kind;
    std::size_t frame;  // within the window; kPrior: the place of the unknown
    double measured, stated_sd;
    double sd = stated_sd;  // that it is weighed by
  };
  static bool is_length(const Row& row);
  // At each frame, in the picture's axes; or its derivatives by one unknown.
  struct Path {
    std::vector<double> x, y, angle;
  };
  struct Prediction : Path {
    std::vector<double> vx, vy, spin;
    std::vector<TrajectoryPoint> trajectory;
  };
  // Of the contact's clock, at each frame.
  std::vector<double> instants(const double* values) const;
  bool predict(const double* values, Prediction& prediction) const;
  double as_measured(const Row& row, double model, const double* values) const;

  // shot_jacobian.cpp
  bool fill_jacobian(const double* values, const Prediction& here, double* jacobian) const;
  std::optional<Path> slope_in_closed_form(const Unknown& unknown, const double* values,
                                           const Prediction& here) const;
  Path slope_in_time(FitParameter parameter, const double* values, const Prediction& here) const;
  // Of each of these unknowns; empty where the motion has none.
  std::vector<Path> slopes_of_motion(std::span<const std::size_t> places, const double* values,
                                     const Prediction& here) const;
  bool slope_by_differences(std::size_t place, const double* values, Path& slope) const;
  double value_or(FitParameter parameter, const double* values, double otherwise) const;
  void build_rows(const MeasuredTrack& track, const MeasuredShot& shot);
  void add_unknowns(const MeasuredShot& shot, const std::vector<FitParameter>& parameters,
                    const std::vector<FitParameter>& unknowns);
  void add_known(FitParameter parameter, double sd);
  double predicted(const Row& row, const Path& p, const double* values) const;

  ImpactJob laws_;
  MeasuredShot shot_;
  double interval_s_ = 0;
  bool has_spin_ = false;
  std::vector<double> time_s_;
  std::vector<Row> rows_;
  std::vector<Unknown> unknowns_;
  std::size_t residuals_ = 0;
};

}  // namespace impactdic::sim::fit
