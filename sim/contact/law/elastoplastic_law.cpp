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
template <typename Real>
class ElasticPlasticNormal final : public NormalLawOf<Real> {
 public:
  using NormalMemory = NormalMemoryOf<Real>;
  using Slopes = typename NormalLawOf<Real>::Slopes;

  explicit ElasticPlasticNormal(const ElasticPlasticLawOf<Real>& law) : law_(law) {}

  Real spring_n(In<Real> deflection_m, const NormalMemory& memory) const override {
    if (!memory.unloading) {
      return signed_like(law_.loading_force_n(abs(deflection_m)), deflection_m);
    }
    const Real fraction = way_back(deflection_m, memory);
    return memory.max_force_n *
           signed_like(power_of(abs(fraction), law_.unloading_exponent(memory.max_deflection_m)),
                       fraction);
  }

  Real work_j(In<Real> deflection_m, const NormalMemory& memory) const override {
    if (!memory.unloading) return law_.loading_energy_j(abs(deflection_m));
    return law_.loading_energy_j(memory.max_deflection_m) -
           law_.released_energy_j(memory.max_deflection_m) + stored_j(deflection_m, memory);
  }

  Real stored_j(In<Real> deflection_m, const NormalMemory& memory) const override {
    if (!memory.unloading) return law_.released_energy_j(abs(deflection_m));
    const Real power = law_.unloading_exponent(memory.max_deflection_m) + 1.0;
    return memory.max_force_n * (memory.max_deflection_m - memory.residual_m) / power *
           power_of(abs(way_back(deflection_m, memory)), power);
  }

  NormalMemory turn(In<Real> deflection_m, const NormalMemory& memory) const override {
    NormalMemory turned = NormalLawOf<Real>::turn(deflection_m, memory);
    turned.residual_m = law_.residual_m(turned.max_deflection_m);
    return turned;
  }

  // Where the published fits change over.
  Real next_kink_m(In<Real> deflection_m) const override { return law_.next_kink_m(deflection_m); }

  Slopes slopes(In<Real> deflection_m, const NormalMemory& memory) const override {
    Slopes slopes;
    if (!memory.unloading) {
      const auto loading = law_.loading_slopes(deflection_m);
      slopes.spring = loading.first;
      slopes.spring_turn = loading.second;
      return slopes;
    }
    const Real way = memory.max_deflection_m - memory.residual_m;
    const Real fraction = way_back(deflection_m, memory);
    if (!(fraction > 0)) return slopes;
    const Real n = law_.unloading_exponent(memory.max_deflection_m);
    slopes.spring = memory.max_force_n * n / way * power_of(fraction, n - 1.0);
    slopes.spring_turn = slopes.spring * (n - 1.0) / (way * fraction);
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
  static Real signed_like(const Real& size, const Real& sign) {
    return sign < 0 ? Real(-size) : size;
  }
  // A base of zero has no logarithm, by which the derivative of a power goes.
  static Real power_of(const Real& base, const Real& exponent) {
    return base > 0 ? pow(base, exponent) : Real(0);
  }
  static Real way_back(In<Real> deflection_m, const NormalMemory& memory) {
    return (deflection_m - memory.residual_m) / (memory.max_deflection_m - memory.residual_m);
  }

  ElasticPlasticLawOf<Real> law_;
};

}  // namespace

template <typename Real>
NormalLawPtr<Real> make_elastoplastic_law(const ImpactJob& job, const JobNumbers<Real>& numbers) {
  const ContactNumbers<Real>& contact = numbers.contact;
  using Law = ElasticPlasticLawOf<Real>;
  const typename Law::Numbers surface{numbers.contact_radius_m(), contact.reduced_modulus_pa,
                                      contact.yield_strength_pa, contact.poisson};
  const Law law(surface, loading_of(job.normal), job.contact.residual);
  return std::make_unique<ElasticPlasticNormal<Real>>(law);
}

template NormalLawPtr<double> make_elastoplastic_law(const ImpactJob&, const JobNumbers<double>&);
template NormalLawPtr<Sensitive> make_elastoplastic_law(const ImpactJob&,
                                                        const JobNumbers<Sensitive>&);

}  // namespace impactdic::sim::contact
