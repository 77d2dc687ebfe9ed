// A simulated impact seen as a camera would see it: residuals against a track, and their Jacobian.
// Internal to sim/fit.
#pragma once

#include <vector>

#include "sim/fit/calibration.h"
#include "sim/fit/track_table.h"

namespace impactdic {

// One entry of the vector of unknowns. Those without a FitParameter are the motion at the touch.
struct Unknown {
  enum class Kind { kParameter, kTouchX, kTouchY, kTangentialVelocity, kNormalVelocity, kSpin };
  Kind kind = Kind::kParameter;
  FitParameter parameter{};
  double start = 0;
  double step = 0;  // of the differences, and the scale of a change
  double lower = 0, upper = 0;
};

class ShotModel {
 public:
  // Compares from the first frame of the flight before to the last of the flight after.
  ShotModel(const Track& track, const Shot& shot, const ImpactJob& laws,
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

 private:
  struct Row {
    enum class Kind { kX, kY, kDx, kDy, kTurn } kind;
    std::size_t frame;  // within the window
    double measured, sd;
  };
  struct Prediction {
    std::vector<double> x, y, angle, vx, vy;
  };
  bool predict(const double* values, Prediction& prediction) const;
  double value_or(FitParameter parameter, const double* values, double otherwise) const;
  void build_rows(const Track& track, const Shot& shot);
  void add_unknowns(const Shot& shot, const std::vector<FitParameter>& parameters,
                    const std::vector<FitParameter>& unknowns);
  double predicted(const Row& row, const Prediction& p) const;

  ImpactJob laws_;
  Shot shot_;
  double interval_s_ = 0;
  bool has_spin_ = false;
  std::vector<double> time_s_;
  std::vector<Row> rows_;
  std::vector<Unknown> unknowns_;
  std::size_t residuals_ = 0;
};

}  // namespace impactdic
