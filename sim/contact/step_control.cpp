#include "sim/contact/step_control.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>

namespace impactdic::sim::contact {

template <typename Real>
ContactScales contact_scales(const ImpactJob& job, const NormalLawOf<Real>& normal,
                             double touch_rate_m_s, const ImpactState& start) {
  const double speed_n = touch_rate_m_s;
  const double reach =
      job.body.shape == BodyShape::kRod ? job.body.length_m / 2 : job.body.radius_m();
  const double spin =
      std::max({std::abs(start[kOmega]), std::abs(start[kOmegaT]), std::abs(start[kOmegaN])});
  const double speed =
      std::max({speed_n, std::abs(start[kVt]), std::abs(start[kVb]), spin * reach});
  double duration = normal.duration_estimate_s(job.body.mass_kg, speed_n);
  if (job.shell) {
    const double soft = job.shell->stiffness_n_per_m / job.body.mass_kg;
    duration = std::max(duration, kPi / std::sqrt(soft));
  }
  const double deflection = normal.deflection_estimate_m(job.body.mass_kg, speed_n);
  const double energy = 0.5 * job.body.mass_kg * speed * speed;
  ContactScales scales{duration, {}};
  scales.state[kQt] = scales.state[kQb] = scales.state[kTip] = speed * duration;
  scales.state[kQn] = deflection;
  scales.state[kAngle] = speed / reach * duration;
  scales.state[kVt] = scales.state[kVb] = speed;
  scales.state[kVn] = speed_n;
  scales.state[kFlat] = job.shell ? deflection : duration;  // or kClock
  scales.state[kFlatRate] = speed_n;
  scales.state[kOmega] = scales.state[kOmegaT] = scales.state[kOmegaN] = speed / reach;
  scales.state[kDamping] = scales.state[kSlip] = energy;
  // It starts like t^1.5, of which the error estimate sees too little.
  scales.state[kSprings] = 0.3 * deflection * std::sqrt(job.body.radius_m() * deflection);
  return scales;
}

template ContactScales contact_scales(const ImpactJob&, const NormalLawOf<double>&, double,
                                      const ImpactState&);
template ContactScales contact_scales(const ImpactJob&, const NormalLawOf<Sensitive>&, double,
                                      const ImpactState&);

}  // namespace impactdic::sim::contact
