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

class DampedHertz final : public NormalLaw {
 public:
  // The damper is scale * d^power * d', the power a multiple of a quarter.
  enum class Power { kQuarter, kHalf, kThreeHalves };

  DampedHertz(double stiffness, double scale, Power power, RestitutionDamping ending,
              double radius_m)
      : stiffness_(stiffness), scale_(scale), power_(power), ending_(ending), radius_(radius_m) {}

  // Below zero deflection the spring continues as an odd function and the damper as an even one, so
  // that an integration step may overshoot.
  double spring_n(double deflection_m, const NormalMemory&) const override {
    return stiffness_ * deflection_m * std::sqrt(std::abs(deflection_m));
  }

  double damper_n(double deflection_m, double rate_m_s, const NormalMemory&) const override {
    const double root = std::sqrt(std::abs(deflection_m));
    switch (power_) {
      case Power::kQuarter:
        return scale_ * std::sqrt(root) * rate_m_s;
      case Power::kHalf:
        return scale_ * root * rate_m_s;
      case Power::kThreeHalves:
        break;
    }
    return scale_ * std::abs(deflection_m) * root * rate_m_s;
  }

  double work_j(double deflection_m, const NormalMemory& memory) const override {
    return spring_n(deflection_m, memory) * deflection_m / 2.5;
  }

  // dP/dt over d^(p - 1), for which the damper's own growth is finite at the touch.
  double force_growth(double deflection_m, double rate_m_s, double acceleration) const override {
    const double d = std::abs(deflection_m), spring = 1.5 * stiffness_ * rate_m_s;
    const double square = rate_m_s * rate_m_s, turn = d * acceleration;
    switch (power_) {
      case Power::kQuarter:
        return spring * d * std::sqrt(std::sqrt(d)) + scale_ * (0.25 * square + turn);
      case Power::kHalf:
        return spring * d + scale_ * (0.5 * square + turn);
      case Power::kThreeHalves:
        break;
    }
    return spring + scale_ * (1.5 * square + turn);
  }

  // At the touch, where some of them are infinite, those of the damper are left out.
  Slopes slopes(double deflection_m, const NormalMemory& memory) const override {
    const double d = std::abs(deflection_m), root = std::sqrt(d);
    Slopes slopes;
    slopes.spring = 1.5 * stiffness_ * root;
    slopes.damper = damper_n(deflection_m, 1, memory);
    if (!(d > 0)) return slopes;
    slopes.spring_turn = 0.75 * stiffness_ / root;
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
    return hertz_duration_s(mass_kg, stiffness_, speed_m_s);
  }
  double deflection_estimate_m(double mass_kg, double speed_m_s) const override {
    return hertz_deflection_m(mass_kg, stiffness_, speed_m_s);
  }

 private:
  double exponent() const {
    if (power_ == Power::kQuarter) return 0.25;
    return power_ == Power::kHalf ? 0.5 : 1.5;
  }

  double stiffness_, scale_;
  Power power_;
  RestitutionDamping ending_;
  double radius_;
};

}  // namespace

std::unique_ptr<NormalLaw> make_damped_hertz(NormalModel model, const ContactParameters& contact,
                                             double radius_m, double mass_kg) {
  const double k = contact.stiffness;
  double scale = 1.5 * k * contact.damping_s_per_m;
  auto power = DampedHertz::Power::kThreeHalves;
  RestitutionDamping ending = RestitutionDamping::kToZeroDeflection;
  if (model == NormalModel::kTsuji) {
    scale = contact.damping_factor * std::sqrt(mass_kg * k);
    power = DampedHertz::Power::kQuarter;
    ending = contact.restitution_damping;
  } else if (model == NormalModel::kKuwabaraKono) {
    scale = 1.5 * k * contact.dissipation_s;
    power = DampedHertz::Power::kHalf;
    ending = contact.restitution_damping;
  }
  return std::make_unique<DampedHertz>(k, scale, power, ending, radius_m);
}

}  // namespace impactdic::sim::contact
