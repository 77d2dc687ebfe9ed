// Hertz's spring with a damper that grows with the contact:
//   tsuji          P = k d^1.5 + alpha sqrt(m k) d^(1/4) d'   Tsuji, Tanaka and Ishida 1992
//   kuwabara_kono  P = k (d^1.5 + 3/2 A d^(1/2) d')           Kuwabara and Kono 1987; Brilliantov,
//                                                             Spahn, Hertzsch and Poeschel 1996
//   hunt_crossley  P = k d^1.5 (1 + 3/2 alpha d')             Hunt and Crossley 1975
// They damp throughout. The first two would pull before the deflection is zero; hunt_crossley does
// not, its force and its deflection end together.
#include <algorithm>
#include <cmath>

#include "sim/contact/law/normal_law.h"

namespace impactdic::sim::contact {
namespace {

template <typename Real>
class DampedHertz final : public NormalLawOf<Real> {
 public:
  using NormalMemory = NormalMemoryOf<Real>;
  using Slopes = typename NormalLawOf<Real>::Slopes;

  // The damper is scale * d^power * d', the power a multiple of a quarter.
  enum class Power { kQuarter, kHalf, kThreeHalves };

  DampedHertz(const Real& stiffness, const Real& scale, Power power, RestitutionDamping ending,
              double radius_m)
      : stiffness_(stiffness), scale_(scale), power_(power), ending_(ending), radius_(radius_m) {}

  // Below zero deflection the spring continues as an odd function and the damper as an even one, so
  // that an integration step may overshoot.
  Real spring_n(In<Real> deflection_m, const NormalMemory&) const override {
    return stiffness_ * deflection_m * root(abs(deflection_m));
  }

  Real damper_n(In<Real> deflection_m, In<Real> rate_m_s, const NormalMemory&) const override {
    const Real rooted = root(abs(deflection_m));
    switch (power_) {
      case Power::kQuarter:
        return scale_ * root(rooted) * rate_m_s;
      case Power::kHalf:
        return scale_ * rooted * rate_m_s;
      case Power::kThreeHalves:
        break;
    }
    return scale_ * abs(deflection_m) * rooted * rate_m_s;
  }

  Real work_j(In<Real> deflection_m, const NormalMemory& memory) const override {
    return spring_n(deflection_m, memory) * deflection_m / 2.5;
  }

  // dP/dt over d^(p - 1), for which the damper's own growth is finite at the touch.
  Real force_growth(In<Real> deflection_m, In<Real> rate_m_s,
                    In<Real> acceleration) const override {
    const Real d = abs(deflection_m), spring = 1.5 * stiffness_ * rate_m_s;
    const Real square = rate_m_s * rate_m_s, turn = d * acceleration;
    switch (power_) {
      case Power::kQuarter:
        return spring * d * root(root(d)) + scale_ * (0.25 * square + turn);
      case Power::kHalf:
        return spring * d + scale_ * (0.5 * square + turn);
      case Power::kThreeHalves:
        break;
    }
    return spring + scale_ * (1.5 * square + turn);
  }

  // At the touch, where some of them are infinite, those of the damper are left out.
  Slopes slopes(In<Real> deflection_m, const NormalMemory& memory) const override {
    const Real d = abs(deflection_m), rooted = root(d);
    Slopes slopes;
    slopes.spring = 1.5 * stiffness_ * rooted;
    slopes.damper = damper_n(deflection_m, Real(1), memory);
    if (!(d > 0)) return slopes;
    slopes.spring_turn = 0.75 * stiffness_ / rooted;
    slopes.damper_slope = exponent() * slopes.damper / d;
    slopes.damper_turn = (exponent() - 1) * slopes.damper_slope / d;
    return slopes;
  }

  RestitutionDamping ending() const override { return ending_; }

  std::string out_of_range(double deflection_m) const override {
    const double part = deflection_m / radius_, limit = 0.2;
    if (part <= limit) return "";
    return beyond_limit("the largest deflection over the radius", part, limit);
  }

  double duration_estimate_s(double mass_kg, double speed_m_s) const override {
    return hertz_duration_s(mass_kg, value_of(stiffness_), speed_m_s);
  }
  double deflection_estimate_m(double mass_kg, double speed_m_s) const override {
    return hertz_deflection_m(mass_kg, value_of(stiffness_), speed_m_s);
  }

 private:
  double exponent() const {
    if (power_ == Power::kQuarter) return 0.25;
    return power_ == Power::kHalf ? 0.5 : 1.5;
  }

  Real stiffness_, scale_;
  Power power_;
  RestitutionDamping ending_;
  double radius_;
};

}  // namespace

template <typename Real>
NormalLawPtr<Real> make_damped_hertz(const ImpactJob& job, const JobNumbers<Real>& numbers) {
  using Law = DampedHertz<Real>;
  const ContactNumbers<Real>& contact = numbers.contact;
  const Real& k = contact.stiffness;
  Real scale = 1.5 * k * contact.damping_s_per_m;
  auto power = Law::Power::kThreeHalves;
  RestitutionDamping ending = RestitutionDamping::kToZeroDeflection;
  if (job.normal == NormalModel::kTsuji) {
    scale = contact.damping_factor * sqrt(numbers.body.mass_kg * k);
    power = Law::Power::kQuarter;
    ending = job.contact.restitution_damping;
  } else if (job.normal == NormalModel::kKuwabaraKono) {
    scale = 1.5 * k * contact.dissipation_s;
    power = Law::Power::kHalf;
    ending = job.contact.restitution_damping;
  }
  return std::make_unique<Law>(k, scale, power, ending, value_of(numbers.contact_radius_m()));
}

template NormalLawPtr<double> make_damped_hertz(const ImpactJob&, const JobNumbers<double>&);
template NormalLawPtr<Sensitive> make_damped_hertz(const ImpactJob&, const JobNumbers<Sensitive>&);

}  // namespace impactdic::sim::contact
