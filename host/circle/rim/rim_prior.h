// What both fits of a rim share: prior knowledge, tests of its shape, errors that neighbours share.
// Internal to host/circle; corrections are (x, y, dR, de1, de2).
#pragma once

#include <Eigen/Dense>
#include <array>

#include "host/circle/circle.h"
#include "host/circle/rim/rim.h"

namespace impactdic::circle {

using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

// What is known beforehand of the corrections, as a quadratic: precision·delta = pull.
struct Knowledge {
  Matrix5 precision = Matrix5::Zero();
  Vector5 pull = Vector5::Zero();
  // The radius of other frames, a part of the above: radius · delta = radius_value ± radius_sd;
  // radius_sd 0: not known.
  Vector5 radius = Vector5::Zero();
  double radius_value = 0, radius_sd = 0;
  // direction · delta = value ± sd.
  void add(const Vector5& direction, double value, double sd);
};

// What a fit owes to the radius of other frames.
struct RadiusShare {
  Vector5 follows = Vector5::Zero();  // by how much the corrections follow an error of it
  Matrix5 alone = Matrix5::Zero();    // the covariance without it
  double moved = 0;                   // and where dR would be, from where it is
};
// Of a fit at `delta` with this precision and covariance, the inverse, under all that is known.
RadiusShare radius_share(const Knowledge& known, const Matrix5& precision,
                         const Matrix5& covariance, const Vector5& delta);
// `r_px`: the fitted radius.
RadiusOfFrame own_radius(const RadiusShare& share, double r_px);

// The uncompressed ball's radius and the axis of its compression, for the rim at `delta`. A
// circle's e1 and e2 are known to be none.
Knowledge knowledge(const Rim& rim, const Vector5& delta, const CirclePrior& prior, Shape shape,
                    double shrink_px);

// χ² of an ellipse against the circle fitted: the score that e1 and e2 have there (Rao's test).
double score_test(const Matrix5& information, const Vector5& score, double wider);
// χ² of e1 and e2 (2 degrees of freedom) for a fitted ellipse: Wald's test.
double wald(const Rim& rim, const Vector5& delta, const Matrix5& covariance);

struct SectorSums {
  std::array<double, kRimSectors> score{}, information{};
  std::array<int, kRimSectors> points{};
};
// How much wider the score scatters than that of independent points. What neighbours share is seen
// in the sums over sectors: independent errors add up as roots, common ones do not. Levels and
// pixel phases that are common to longer arcs add `common_px` to every sector.
double inflation(const SectorSums& sums, double information, double common_px, int parameters);

// Covariance of the corrections that light which is not the model's adds: it misplaces the rim in
// waves around it. How much is seen in the waves 2 to 5 of the sums over sectors, beyond what
// chance leaves there (`wider`: what `inflation` says). Waves 0 and 1, which the fit has taken for
// radius and centre, are taken to have as much. `ink`: not light makes the waves, but ink, as of an
// outline and in even light; fine ones are then as strong as long ones. `covariance`: of the fit at
// whose maximum the sums are.
Matrix5 wavy_light(const SectorSums& sums, double wider, const Matrix5& covariance, bool ink);

}  // namespace impactdic::circle
