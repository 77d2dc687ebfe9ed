#include "host/impact/flight/unknowns.h"

namespace impactdic::impact {

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

}  // namespace impactdic::impact
