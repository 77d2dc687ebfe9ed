// What a surface takes from a ball's rolling and from its spin about the normal, beside friction.
//
// Both are couples against the turning,
//   rolling    mu_r R P w/sqrt(|w|^2 + w_0^2),   w the part of the spin along the surface
//   spinning   3 pi/16 mu_s a P w_n/sqrt(w_n^2 + w_0^2),   a = sqrt(R delta)
// the first with the coefficient of rolling friction as DEM codes have it (Zhou, Wright, Yang, Xu
// and Yu 1999), the second what dry friction gives under Hertz's pressure where all of the contact
// turns, the integral of mu p r over it. Below w_0, a thousandth of the speed over the radius, they
// fade, so that what has stopped stays so.
#pragma once

#include <numbers>

#include "sim/contact/law/friction_law.h"
#include "sim/contact/numbers/numbers.h"
#include "sim/contact/numbers/state.h"

namespace impactdic::sim::contact {

template <typename Real>
class TurningResistance {
 public:
  using State = ImpactStateOf<Real>;

  explicit TurningResistance(const JobNumbers<Real>& numbers)
      : rolling_(numbers.contact.rolling_friction),
        spinning_(numbers.contact.spinning_friction),
        radius_m_(numbers.body.radius_m()) {
    const MotionNumbers<Real>& m = numbers.initial;
    // Not hypot, which has no slope by a velocity that is zero.
    const Real speed = root(Real(m.vt_m_s * m.vt_m_s + m.vn_m_s * m.vn_m_s + m.vb_m_s * m.vb_m_s));
    fading_rad_s_ = kFading * speed / radius_m_;
  }

  bool of_rolling() const { return rolling_ > 0; }
  bool acts() const { return rolling_ > 0 || spinning_ > 0; }

  // Against the spin about b, t and n. N m.
  struct Couple {
    Real b{}, t{}, n{};
  };
  Couple couple(const State& x, const Real& normal_n, const Real& deflection_m) const {
    Couple couple;
    const Real &b = x[kOmega], &t = x[kOmegaT], &n = x[kOmegaN];
    const Real fading = fading_rad_s_ * fading_rad_s_;
    const Real roll = -rolling_ * radius_m_ * normal_n / sqrt(b * b + t * t + fading);
    couple.b = roll * b, couple.t = roll * t;
    const Real contact_m = root(Real(radius_m_ * at_least(deflection_m, 0)));
    couple.n = -kHertz * spinning_ * contact_m * normal_n * n / sqrt(n * n + fading);
    return couple;
  }
  // What it takes away, W.
  Real dissipation_w(const State& x, const Couple& couple) const {
    return -(couple.b * x[kOmega] + couple.t * x[kOmegaT] + couple.n * x[kOmegaN]);
  }

 private:
  static constexpr double kFading = 1e-3, kHertz = 3 * std::numbers::pi / 16;
  Real rolling_, spinning_, radius_m_, fading_rad_s_;
};

}  // namespace impactdic::sim::contact
