// Least squares of paths along one axis against what was measured of a ball. Internal to the impact
// analysis.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "host/impact/evidence/path_shapes.h"
#include "host/impact/impact_series.h"

namespace impactdic::impact {

struct PathFit {
  // Schwarz' criterion, twice a negative logarithm.
  double score = std::numeric_limits<double>::infinity();
  Eigen::VectorXd residuals;
};

enum class PathSource { kCentresAndSteps, kSteps };

class PathFits {
 public:
  // What `source` names in `span`, less single frames that lie far from those about them; none is
  // taken to scatter by less than `least_px`. Steps taken from centres are those.
  PathFits(const ImpactSeries& series, const PathSpan& span, double least_px = 0,
           PathSource source = PathSource::kCentresAndSteps);

  std::size_t size() const { return samples_.size(); }

  // `more`: unknowns beside the factors of `basis`.
  PathFit fit(const Basis& basis, int more = 0) const;

  // The scores of the first `fewest` functions of `basis`, of `step` more, and so on to all of
  // them.
  std::vector<double> scores(const Basis& basis, std::size_t fewest, std::size_t step,
                             int more = 0) const;

  // Weights of places and steps by what `fit` leaves of each outside of the contact, or in all
  // frames where most are in it, and how many frames of each count as one because they err alike.
  void take_scatter(const PathFit& fit, const PathSpan& span);

 private:
  enum Kind { kPlace, kStep, kKinds };

  struct Sample {
    double at, value;  // a step leads to at + 1
    Kind kind;
  };

  // Of least squares, every deviation 1; `scale` is that of the unknowns, `normal`, below its
  // diagonal, which is 1.
  struct Equations {
    Eigen::MatrixXd slopes, normal;
    Eigen::VectorXd values, right, scale;
  };

  void add(const std::vector<double>& all, const PathSpan& span, Kind kind);
  Equations equations(const Basis& basis) const;
  // Of samples as if each erred by itself.
  double sd(Kind kind) const;
  double score(double squares, std::size_t factors, int more) const;

  double least_px_;
  std::vector<Sample> samples_;
  std::vector<double> instants_;  // of all samples, ascending
  std::array<double, kKinds> count_{}, scale_{}, alike_ = {1, 1};
};

}  // namespace impactdic::impact
