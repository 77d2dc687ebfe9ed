// The elastic-plastic contact as the normal law of an impact.
#include <impactdic/error.h>

#include <cmath>

#include "sim/contact/law/normal_elastoplastic.h"
#include "sim/contact/law/normal_law.h"

namespace impactdic::sim::contact {
namespace {

PlasticLoading loading_of(NormalModel model) {
  switch (model) {
    case NormalModel::kJacksonGreen:
      return PlasticLoading::kJacksonGreen;
    case NormalModel::kKogutEtsion:
      return PlasticLoading::kKogutEtsion;
    case NormalModel::kThornton:
      return PlasticLoading::kThornton;
    case NormalModel::kStronge:
      return PlasticLoading::kStronge;
    default:
      throw InvalidArgument("not an elastic-plastic law", "normal");
  }
}

// The law as an impact's normal law. Below zero force it continues as an odd function, so that an
// integration step may overshoot.
class ElasticPlasticNormal final : public NormalLaw {
 public:
  explicit ElasticPlasticNormal(const ElasticPlasticLaw& law) : law_(law) {}

  double spring_n(double deflection_m, const NormalMemory& memory) const override {
    if (!memory.unloading) {
      return std::copysign(law_.loading_force_n(std::abs(deflection_m)), deflection_m);
    }
    const double fraction = way_back(deflection_m, memory);
    return memory.max_force_n *
           std::copysign(
               std::pow(std::abs(fraction), law_.unloading_exponent(memory.max_deflection_m)),
               fraction);
  }

  double work_j(double deflection_m, const NormalMemory& memory) const override {
    if (!memory.unloading) return law_.loading_energy_j(std::abs(deflection_m));
    return law_.loading_energy_j(memory.max_deflection_m) -
           law_.released_energy_j(memory.max_deflection_m) + stored_j(deflection_m, memory);
  }

  double stored_j(double deflection_m, const NormalMemory& memory) const override {
    if (!memory.unloading) return law_.released_energy_j(std::abs(deflection_m));
    const double power = law_.unloading_exponent(memory.max_deflection_m) + 1;
    return memory.max_force_n * (memory.max_deflection_m - memory.residual_m) / power *
           std::pow(std::abs(way_back(deflection_m, memory)), power);
  }

  NormalMemory turn(double deflection_m, const NormalMemory& memory) const override {
    NormalMemory turned = NormalLaw::turn(deflection_m, memory);
    turned.residual_m = law_.residual_m(turned.max_deflection_m);
    return turned;
  }

  // Where the published fits change over.
  double next_kink_m(double deflection_m) const override { return law_.next_kink_m(deflection_m); }

  Slopes slopes(double deflection_m, const NormalMemory& memory) const override {
    Slopes slopes;
    if (!memory.unloading) {
      const ElasticPlasticLaw::LoadingSlopes loading = law_.loading_slopes(deflection_m);
      slopes.spring = loading.first;
      slopes.spring_turn = loading.second;
      return slopes;
    }
    const double way = memory.max_deflection_m - memory.residual_m;
    const double fraction = way_back(deflection_m, memory);
    if (!(fraction > 0)) return slopes;
    const double n = law_.unloading_exponent(memory.max_deflection_m);
    slopes.spring = memory.max_force_n * n / way * std::pow(fraction, n - 1);
    slopes.spring_turn = slopes.spring * (n - 1) / (way * fraction);
    return slopes;
  }

  std::string out_of_range(double deflection_m) const override {
    return law_.out_of_range(deflection_m);
  }

  // Half a period of Hertz's contact to the same depth.
  double duration_estimate_s(double mass_kg, double speed_m_s) const override {
    return 2.94328 * deflection_estimate_m(mass_kg, speed_m_s) / speed_m_s;
  }

  double deflection_estimate_m(double mass_kg, double speed_m_s) const override {
    return law_.largest_compression_m(mass_kg, speed_m_s);
  }

 private:
  static double way_back(double deflection_m, const NormalMemory& memory) {
    return (deflection_m - memory.residual_m) / (memory.max_deflection_m - memory.residual_m);
  }

  ElasticPlasticLaw law_;
};

}  // namespace

std::unique_ptr<NormalLaw> make_elastoplastic_law(NormalModel model,
                                                  const ContactParameters& contact,
                                                  double radius_m) {
  const ElasticPlasticSurface surface{radius_m, contact.reduced_modulus_pa,
                                      contact.yield_strength_pa, contact.poisson};
  return std::make_unique<ElasticPlasticNormal>(
      ElasticPlasticLaw(surface, loading_of(model), contact.residual));
}

}  // namespace impactdic::sim::contact
