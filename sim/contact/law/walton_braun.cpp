// Walton and Braun (1986): P = k1 d while the contact is loaded for the first time, and back along
// P = k2 (d - d0) with k2 = k + S P_m, so that e = sqrt(k1 / k2). With S = 0 the restitution does
// not depend on the speed; with k = k1 it is e = sqrt(w / (w + S v)), w = sqrt(k1 / m). What is
// loaded again follows the way back until it is loaded farther than before.
#include <impactdic/units.h>

#include <cmath>

#include "sim/contact/law/normal_law.h"

namespace impactdic::sim::contact {
namespace {

template <typename Real>
class WaltonBraun final : public NormalLawOf<Real> {
 public:
  using NormalMemory = NormalMemoryOf<Real>;
  using Slopes = typename NormalLawOf<Real>::Slopes;

  explicit WaltonBraun(const JobNumbers<Real>& numbers)
      : loading_(numbers.contact.stiffness),
        least_unloading_(numbers.contact.unloading_stiffness_n_per_m),
        hardening_(numbers.contact.unloading_hardening_per_m),
        radius_(value_of(numbers.contact_radius_m())) {}

  Real spring_n(In<Real> deflection_m, const NormalMemory& memory) const override {
    if (!memory.unloading) return loading_ * deflection_m;
    return unloading(memory.max_force_n) * (deflection_m - memory.residual_m);
  }

  Real work_j(In<Real> deflection_m, const NormalMemory& memory) const override {
    if (!memory.unloading) return 0.5 * loading_ * deflection_m * deflection_m;
    const Real lost = 0.5 * memory.max_force_n * memory.residual_m;
    return lost + stored_j(deflection_m, memory);
  }

  Real stored_j(In<Real> deflection_m, const NormalMemory& memory) const override {
    const Real force = spring_n(deflection_m, memory);
    const Real most = memory.unloading ? memory.max_force_n : abs(force);
    return 0.5 * force * force / unloading(most);
  }

  NormalMemory turn(In<Real> deflection_m, const NormalMemory& memory) const override {
    NormalMemory turned = NormalLawOf<Real>::turn(deflection_m, memory);
    turned.residual_m =
        turned.max_deflection_m - turned.max_force_n / unloading(turned.max_force_n);
    return turned;
  }

  Slopes slopes(In<Real>, const NormalMemory& memory) const override {
    Slopes slopes;
    slopes.spring = memory.unloading ? unloading(memory.max_force_n) : loading_;
    return slopes;
  }

  std::string out_of_range(double deflection_m) const override {
    const double part = deflection_m / radius_;
    if (part <= 1) return "";
    return beyond_limit("the largest deflection over the radius", part, 1);
  }

  double duration_estimate_s(double mass_kg, double) const override {
    return kPi * std::sqrt(mass_kg / value_of(loading_));
  }
  double deflection_estimate_m(double mass_kg, double speed_m_s) const override {
    return speed_m_s * std::sqrt(mass_kg / value_of(loading_));
  }

 private:
  Real unloading(In<Real> max_force_n) const { return least_unloading_ + hardening_ * max_force_n; }

  Real loading_, least_unloading_, hardening_;
  double radius_;
};

}  // namespace

template <typename Real>
NormalLawPtr<Real> make_walton_braun(const JobNumbers<Real>& numbers) {
  return std::make_unique<WaltonBraun<Real>>(numbers);
}

template NormalLawPtr<double> make_walton_braun(const JobNumbers<double>&);
template NormalLawPtr<Sensitive> make_walton_braun(const JobNumbers<Sensitive>&);

}  // namespace impactdic::sim::contact
