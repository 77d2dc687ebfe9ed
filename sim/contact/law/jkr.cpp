// Johnson, Kendall and Roberts (1971): an elastic sphere that sticks to the surface with the work
// of adhesion w. With the contact's radius a and c = sqrt(2 pi w / E*),
//   d = a^2/R - c sqrt(a)        P = 4 E* a^3/(3 R) - 2 E* c a^1.5
// The bodies snap together at d = 0 and part at the least d, where the deflection, not the force,
// is what the motion prescribes. What it takes from d = 0 to there, 7.09 (w^5 R^4/E*^2)^(1/3), the
// rebound loses (Thornton and Ning 1998).
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>

#include "sim/contact/law/normal_law.h"

namespace impactdic::sim::contact {
namespace {

template <typename Real>
class Jkr final : public NormalLawOf<Real> {
 public:
  using NormalMemory = NormalMemoryOf<Real>;
  using Slopes = typename NormalLawOf<Real>::Slopes;

  explicit Jkr(const JobNumbers<Real>& numbers)
      : modulus_(numbers.contact.reduced_modulus_pa),
        radius_(numbers.contact_radius_m()),
        pull_(root(2.0 * kPi * numbers.contact.adhesion_j_per_m2 / modulus_)),
        least_root_(cube_root(pull_ * radius_ / 4.0)),
        least_deflection_m_(-0.75 * pull_ * least_root_),
        touch_j_(branch_j(cube_root(pull_ * radius_))) {}

  // Beyond the least deflection the force stays, so that an integration step may overshoot.
  Real spring_n(In<Real> deflection_m, const NormalMemory&) const override {
    return force_n(root_of_width(deflection_m));
  }

  Real work_j(In<Real> deflection_m, const NormalMemory&) const override {
    const Real beyond = -at_least(least_deflection_m_ - deflection_m, 0);
    return branch_j(root_of_width(deflection_m)) - touch_j_ + force_n(least_root_) * beyond;
  }

  NormalMemory turn(In<Real> deflection_m, const NormalMemory& memory) const override {
    NormalMemory turned = NormalLawOf<Real>::turn(deflection_m, memory);
    turned.residual_m = least_deflection_m_;
    return turned;
  }

  // dP/ds over dd/ds. The second derivative is not asked for: no law follows partial slip here.
  Slopes slopes(In<Real> deflection_m, const NormalMemory&) const override {
    const Real s = root_of_width(deflection_m), cube = s * s * s;
    const Real force = 2.0 * modulus_ * s * s * (4.0 * cube / radius_ - 3.0 * pull_);
    const Real way = 4.0 * cube / radius_ - pull_;
    Slopes slopes;
    if (way > 0) slopes.spring = force / way;
    return slopes;
  }

  bool adhesive() const override { return pull_ > 0; }

  std::string out_of_range(double deflection_m) const override {
    const double radius = value_of(radius_), part = deflection_m / radius, limit = 0.2;
    if (part > limit) return beyond_limit("the largest deflection over the radius", part, limit);
    const double least = value_of(least_root_), neck = least * least / radius;
    if (neck > limit) return beyond_limit("the neck's radius over the body's", neck, limit);
    return "";
  }

  double duration_estimate_s(double mass_kg, double speed_m_s) const override {
    return hertz_duration_s(mass_kg, value_of(stiffness()), speed_m_s);
  }
  double deflection_estimate_m(double mass_kg, double speed_m_s) const override {
    return hertz_deflection_m(mass_kg, value_of(stiffness()), speed_m_s);
  }

 private:
  Real stiffness() const { return 4.0 / 3.0 * modulus_ * sqrt(radius_); }

  // s = sqrt(a).
  Real force_n(Real s) const {
    const Real cube = s * s * s;
    return 2.0 * modulus_ * cube * (2.0 * cube / (3.0 * radius_) - pull_);
  }

  // int P dd along the branch, from s = 0.
  Real branch_j(Real s) const {
    const Real cube = s * s * s, part = cube / radius_;
    return 2.0 * modulus_ * cube * s *
           (4.0 * part * part / 15.0 - 2.0 * pull_ * part / 3.0 + pull_ * pull_ / 4.0);
  }

  // The larger root of s^4/R - c s = d. Both starts lie above it, where the curve is convex, so
  // that Newton's method comes down to it.
  Real root_of_width(In<Real> deflection_m) const {
    const Real above = deflection_m - least_deflection_m_;
    if (!(above > 0)) return least_root_;
    const Real wide = cube_root(pull_ * radius_) + root(root(at_least(deflection_m, 0) * radius_));
    Real s = wide;
    if (least_root_ > 0) {
      s = std::min<Real>(s, least_root_ + root(above * radius_ / 6.0) / least_root_);
    }
    for (int i = 0; i < 60; ++i) {
      const Real cube = s * s * s / radius_;
      const Real next = s - (s * (cube - pull_) - deflection_m) / (4.0 * cube - pull_);
      if (!(next < s)) break;
      const bool close = s - next < 1e-15 * s;
      s = next;
      if (close) break;
    }
    return polished(s, deflection_m);
  }
  // A root that is exact in value: one step more of Newton's method gives its derivatives.
  Real polished(const Real& s, In<Real> deflection_m) const {
    if constexpr (kHasDerivatives<Real>) {
      const Real fixed(value_of(s)), cube = fixed * fixed * fixed / radius_;
      const Real missing = fixed * (cube - pull_) - deflection_m;
      return {value_of(s), -missing.v / value_of(4.0 * cube - pull_)};
    } else {
      return s;
    }
  }
  static Real cube_root(const Real& x) { return x > 0 ? cbrt(x) : Real(0); }

  Real modulus_, radius_;
  Real pull_;  // c
  Real least_root_, least_deflection_m_;
  Real touch_j_;
};

}  // namespace

template <typename Real>
NormalLawPtr<Real> make_jkr(const JobNumbers<Real>& numbers) {
  return std::make_unique<Jkr<Real>>(numbers);
}

template NormalLawPtr<double> make_jkr(const JobNumbers<double>&);
template NormalLawPtr<Sensitive> make_jkr(const JobNumbers<Sensitive>&);

}  // namespace impactdic::sim::contact
