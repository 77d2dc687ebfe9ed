#include "sim/contact/law/normal_law.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace impactdic::sim::contact {

template <typename Real>
Real NormalLawOf<Real>::damper_n(In<Real>, In<Real>, const NormalMemory&) const {
  return Real(0);
}

template <typename Real>
Real NormalLawOf<Real>::stored_j(In<Real> deflection_m, const NormalMemory& memory) const {
  return work_j(deflection_m, memory);
}

template <typename Real>
auto NormalLawOf<Real>::turn(In<Real> deflection_m, const NormalMemory& memory) const
    -> NormalMemory {
  NormalMemory turned = memory;
  turned.compressing = false;
  if (!memory.unloading) {
    turned.unloading = true;
    turned.max_deflection_m = deflection_m;
    turned.max_force_n = spring_n(deflection_m, memory);
  }
  return turned;
}

template <typename Real>
Real NormalLawOf<Real>::force_growth(In<Real>, In<Real>, In<Real>) const {
  return Real(1);
}

std::string beyond_limit(const char* what, double value, double limit) {
  char text[160];
  std::snprintf(text, sizeof text, "%s is %.3g, and the law holds to %g", what, value, limit);
  return text;
}

template <typename Real>
Real NormalLawOf<Real>::next_kink_m(In<Real>) const {
  return Real(std::numeric_limits<double>::infinity());
}

double hertz_deflection_m(double mass_kg, double stiffness, double speed_m_s) {
  return std::pow(1.25 * mass_kg * speed_m_s * speed_m_s / stiffness, 0.4);
}

// 0.8 sqrt(pi) Gamma(0.4)/Gamma(0.9) delta_m/v.
double hertz_duration_s(double mass_kg, double stiffness, double speed_m_s) {
  return 2.94328 * hertz_deflection_m(mass_kg, stiffness, speed_m_s) / speed_m_s;
}

template <typename Real>
double NormalLawOf<Real>::deflection_estimate_m(double mass_kg, double speed_m_s) const {
  return speed_m_s * duration_estimate_s(mass_kg, speed_m_s) / kPi;
}

namespace {

// P = k delta^p + b delta' (source Eqs 3.6, 3.10 with p = 1; Eqs 4.8, 4.9 with p = 3/2). Below zero
// deflection the spring continues as an odd function, so that an integration step may overshoot.
template <typename Real>
class SpringDamper final : public NormalLawOf<Real> {
 public:
  using NormalMemory = NormalMemoryOf<Real>;
  using Slopes = typename NormalLawOf<Real>::Slopes;

  SpringDamper(bool hertz, const ImpactJob& job, const JobNumbers<Real>& numbers)
      : hertz_(hertz),
        stiffness_(numbers.contact.stiffness),
        damping_(numbers.contact.damping_n_s_per_m),
        radius_(value_of(numbers.contact_radius_m())),
        ending_(job.contact.restitution_damping),
        damped_restitution_(ending_ != RestitutionDamping::kNone) {}

  Real spring_n(In<Real> deflection_m, const NormalMemory&) const override {
    const Real force = stiffness_ * deflection_m;
    return hertz_ ? force * root(abs(deflection_m)) : force;
  }

  Real damper_n(In<Real>, In<Real> rate_m_s, const NormalMemory& memory) const override {
    return memory.compressing || damped_restitution_ ? damping_ * rate_m_s : Real(0);
  }

  Real work_j(In<Real> deflection_m, const NormalMemory& memory) const override {
    return spring_n(deflection_m, memory) * deflection_m / (hertz_ ? 2.5 : 2.0);
  }

  Real force_growth(In<Real> deflection_m, In<Real> rate_m_s,
                    In<Real> acceleration) const override {
    const Real slope = hertz_ ? 1.5 * stiffness_ * root(abs(deflection_m)) : stiffness_;
    return slope * rate_m_s + damping_ * acceleration;
  }

  Slopes slopes(In<Real> deflection_m, const NormalMemory& memory) const override {
    Slopes slopes;
    slopes.damper = damper_n(deflection_m, Real(1), memory);
    slopes.spring = stiffness_;
    if (!hertz_) return slopes;
    const Real rooted = root(abs(deflection_m));
    slopes.spring *= 1.5 * rooted;
    if (rooted > 0) slopes.spring_turn = 0.75 * stiffness_ / rooted;
    return slopes;
  }

  RestitutionDamping ending() const override { return ending_; }

  // A linear spring does not ask what presses it, but nothing is pressed deeper than through.
  std::string out_of_range(double deflection_m) const override {
    const double limit = hertz_ ? 0.2 : 1, part = deflection_m / radius_;
    if (part <= limit) return "";
    return beyond_limit("the largest deflection over the radius", part, limit);
  }

  // Undamped.
  double duration_estimate_s(double mass_kg, double speed_m_s) const override {
    if (!hertz_) return kPi * std::sqrt(mass_kg / value_of(stiffness_));
    return hertz_duration_s(mass_kg, value_of(stiffness_), speed_m_s);
  }

  double deflection_estimate_m(double mass_kg, double speed_m_s) const override {
    if (!hertz_) return speed_m_s * std::sqrt(mass_kg / value_of(stiffness_));
    return hertz_deflection_m(mass_kg, value_of(stiffness_), speed_m_s);
  }

 private:
  bool hertz_;
  Real stiffness_, damping_;
  double radius_;
  RestitutionDamping ending_;
  bool damped_restitution_;
};

}  // namespace

template <typename Real>
NormalLawPtr<Real> make_normal_law(const ImpactJob& job, const JobNumbers<Real>& numbers) {
  switch (job.normal) {
    case NormalModel::kLinearSpringDamper:
      return std::make_unique<SpringDamper<Real>>(false, job, numbers);
    case NormalModel::kHertzDamper:
      return std::make_unique<SpringDamper<Real>>(true, job, numbers);
    case NormalModel::kTsuji:
    case NormalModel::kKuwabaraKono:
    case NormalModel::kHuntCrossley:
      return make_damped_hertz(job, numbers);
    case NormalModel::kWaltonBraun:
      return make_walton_braun(numbers);
    case NormalModel::kJkr:
      return make_jkr(numbers);
    default:
      return make_elastoplastic_law(job, numbers);
  }
}

template class NormalLawOf<double>;
template class NormalLawOf<Sensitive>;
template NormalLawPtr<double> make_normal_law(const ImpactJob&, const JobNumbers<double>&);
template NormalLawPtr<Sensitive> make_normal_law(const ImpactJob&, const JobNumbers<Sensitive>&);

}  // namespace impactdic::sim::contact
