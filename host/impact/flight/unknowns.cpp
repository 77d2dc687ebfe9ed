#include "host/impact/flight/unknowns.h"

#include <algorithm>

namespace impactdic::impact {
namespace {

constexpr double kLeastNearnessSd = 1e-7;
// How far off the centre the point lies that is followed, at least. It is a circle's centre, which
// the texture under the rim misplaces. It turns along with the ball, and neither centres nor
// motions, which are about that place, tell it from a path.
constexpr double kOffsetSd_px = 0.05;
// What foreshortening makes of a pose against its keyframe and of its turn in the picture's plane,
// in proportion (sixteen flights of four patterns, R 115 px).
constexpr double kLinkedTurnModel = 1.4e-4, kLinkedRollModel = 1e-4;

}  // namespace

void Unknowns::follow(int flight, double circle_sd_px) {
  followed_sd_px_[static_cast<std::size_t>(flight)] = circle_sd_px;
}

Eigen::VectorXd Unknowns::row_of(const Datum& d) const {
  Eigen::VectorXd row = Eigen::VectorXd::Zero(count());
  for (int k = 0; k < kStatesOfOne; ++k) {
    row[kStatesOfOne * d.flight + k] = d.slope[static_cast<std::size_t>(k)];
  }
  if (free_) row[states()] = across_ ? d.across_slope : d.gravity_slope;
  if (has_offsets()) row.segment<2>(offset(d.flight)) << d.offset_slope[0], d.offset_slope[1];
  if (has_rims()) row.segment<2>(rim(d.flight)) << d.rim_slope[0], d.rim_slope[1];
  if (!sphere_) return row;
  row[radius()] = d.radius_slope;
  row[nearness()] = d.nearness_slope;
  for (int k = 0; k < spins(); ++k) {
    row[spin(d.flight) + k] = d.spin_slope[static_cast<std::size_t>(k)];
  }
  if (linked_) row.segment<2>(model(d.flight)) << d.tilted_slope, d.rolled_slope;
  return row;
}

void Unknowns::add_priors(const ImpactSeries& series, double circle_sd_px,
                          Eigen::MatrixXd& normal) const {
  const auto add = [&normal](int column, int count, double sd) {
    normal.diagonal().segment(column, count).array() += 1 / (sd * sd);
  };
  for (int flight = 0; has_offsets() && flight < flights_; ++flight) {
    const double followed = followed_sd_px_[static_cast<std::size_t>(flight)];
    add(offset(flight), 2, std::max(kOffsetSd_px, followed));
  }
  if (has_rims()) add(rim(0), 2 * flights_, circle_sd_px);
  if (!sphere_) return;
  add(radius(), 1, series.sphere->radius_sd_px());
  add(nearness(), 1, std::max(series.sphere->nearness_sd(), kLeastNearnessSd));
  for (int flight = 0; linked_ && flight < flights_; ++flight) {
    add(model(flight), 1, kLinkedTurnModel);
    add(model(flight) + 1, 1, kLinkedRollModel);
  }
}

}  // namespace impactdic::impact
