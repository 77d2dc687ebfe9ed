// Walton and Braun (1986): P = k1 d while the contact is loaded for the first time, and back along
// P = k2 (d - d0) with k2 = k + S P_m, so that e = sqrt(k1 / k2). With S = 0 the restitution does
// not depend on the speed; with k = k1 it is e = sqrt(w / (w + S v)), w = sqrt(k1 / m). What is
// loaded again follows the way back until it is loaded farther than before.
#include <impactdic/units.h>

#include <cmath>

#include "sim/contact/law/normal_law.h"

namespace impactdic::sim::contact {
namespace {

class WaltonBraun final : public NormalLaw {
 public:
  WaltonBraun(const ContactParameters& contact, double radius_m)
      : loading_(contact.stiffness),
        least_unloading_(contact.unloading_stiffness_n_per_m),
        hardening_(contact.unloading_hardening_per_m),
        radius_(radius_m) {}

  double spring_n(double deflection_m, const NormalMemory& memory) const override {
    if (!memory.unloading) return loading_ * deflection_m;
    return unloading(memory.max_force_n) * (deflection_m - memory.residual_m);
  }

  double work_j(double deflection_m, const NormalMemory& memory) const override {
    if (!memory.unloading) return 0.5 * loading_ * deflection_m * deflection_m;
    const double lost = 0.5 * memory.max_force_n * memory.residual_m;
    return lost + stored_j(deflection_m, memory);
  }

  double stored_j(double deflection_m, const NormalMemory& memory) const override {
    const double force = spring_n(deflection_m, memory);
    const double most = memory.unloading ? memory.max_force_n : std::abs(force);
    return 0.5 * force * force / unloading(most);
  }

  NormalMemory turn(double deflection_m, const NormalMemory& memory) const override {
    NormalMemory turned = NormalLaw::turn(deflection_m, memory);
    turned.residual_m =
        turned.max_deflection_m - turned.max_force_n / unloading(turned.max_force_n);
    return turned;
  }

  Slopes slopes(double, const NormalMemory& memory) const override {
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
    return kPi * std::sqrt(mass_kg / loading_);
  }
  double deflection_estimate_m(double mass_kg, double speed_m_s) const override {
    return speed_m_s * std::sqrt(mass_kg / loading_);
  }

 private:
  double unloading(double max_force_n) const { return least_unloading_ + hardening_ * max_force_n; }

  double loading_, least_unloading_, hardening_, radius_;
};

}  // namespace

std::unique_ptr<NormalLaw> make_walton_braun(const ContactParameters& contact, double radius_m) {
  return std::make_unique<WaltonBraun>(contact, radius_m);
}

}  // namespace impactdic::sim::contact
