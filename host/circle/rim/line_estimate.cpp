#include "host/circle/rim/line_estimate.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "host/circle/settings/line_fit.h"

namespace impactdic::circle {

void describe(const Rim& rim, const Vector5& delta, const Knowledge& known, double step_px,
              LineEstimate& estimate) {
  const LineSums& s = estimate.sums;
  const int parameters = estimate.shape == Shape::kEllipse ? 5 : 3;
  const double wider = inflation(s.sectors, s.hessian_sum, kLineFit.common_px, parameters);
  const Matrix5 precision = s.hessian / wider + known.precision;
  estimate.delta = delta;
  estimate.covariance = Eigen::LDLT<Matrix5>(precision).solve(Matrix5::Identity());
  estimate.misplaced = misplaced(s, wider, estimate.covariance);
  estimate.wider = wider;
  const RadiusShare share = radius_share(known, precision, estimate.covariance, delta);
  estimate.own = own_radius(share, rim.r + delta[2]);
  estimate.own.misplaced = misplaced(s, wider, share.alone)(2, 2);
  if (estimate.shape == Shape::kCircle) estimate.oval = score_test(s.hessian, s.score, wider);
  estimate.scatter = step_px * std::sqrt(s.scatter / std::max(s.kinds[0], 1e-9f));
  estimate.arc = 0;
  for (int count : s.sectors.points) estimate.arc += count > 0 ? 1.0 / kRimSectors : 0;
}

bool is_plainly_oval(const Rim& rim, const LineEstimate& oval, const RimModel& model) {
  // What the model may misplace makes ellipses of circles too.
  const double place = model.place_sd_px();
  const Matrix5 covariance = oval.covariance + place * place * oval.misplaced;
  return wald(rim, oval.delta, covariance) > kPrior.significant;
}

LineFit fit_of(const LineEstimate& best, const Rim& rim) {
  LineFit fit;
  fit.ok = true;
  fit.ellipse = best.shape == Shape::kEllipse;
  fit.rim = {rim.cx + best.delta[0], rim.cy + best.delta[1], rim.r + best.delta[2],
             fit.ellipse ? rim.e1 + best.delta[3] : 0, fit.ellipse ? rim.e2 + best.delta[4] : 0};
  for (int i = 0; i < 5; ++i) {
    fit.sd[i] = std::sqrt(std::max(0.0, best.covariance(i, i)));
    fit.misplaced[i] = std::max(0.0, best.misplaced(i, i));
  }
  for (int i = 0; i < 2; ++i) fit.with_radius[i] = best.covariance(i, 2) / best.covariance(2, 2);
  fit.own = best.own;
  fit.residual_px = best.scatter;
  fit.shares = best.shares;
  double lines = 0;
  for (const float kind : best.sums.kinds) lines += kind;
  fit.bare = best.sums.kinds[0] / std::max(lines, 1e-9);
  fit.wider = best.wider;
  fit.points = best.points;
  fit.arc = best.arc;
  return fit;
}

}  // namespace impactdic::circle
