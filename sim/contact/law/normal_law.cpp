#include "sim/contact/law/normal_law.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace impactdic::sim::contact {

double NormalLaw::damper_n(double, double, const NormalMemory&) const { return 0; }

double NormalLaw::stored_j(double deflection_m, const NormalMemory& memory) const {
  return work_j(deflection_m, memory);
}

NormalMemory NormalLaw::turn(double deflection_m, const NormalMemory& memory) const {
  NormalMemory turned = memory;
  turned.compressing = false;
  if (!memory.unloading) {
    turned.unloading = true;
    turned.max_deflection_m = deflection_m;
    turned.max_force_n = spring_n(deflection_m, memory);
  }
  return turned;
}

double NormalLaw::force_growth(double, double, double) const { return 1; }

std::string beyond_limit(const char* what, double value, double limit) {
  char text[160];
  std::snprintf(text, sizeof text, "%s is %.3g, and the law holds to %g", what, value, limit);
  return text;
}

double NormalLaw::next_kink_m(double) const { return std::numeric_limits<double>::infinity(); }

double hertz_deflection_m(double mass_kg, double stiffness, double speed_m_s) {
  return std::pow(1.25 * mass_kg * speed_m_s * speed_m_s / stiffness, 0.4);
}

// 0.8 sqrt(pi) Gamma(0.4)/Gamma(0.9) delta_m/v.
double hertz_duration_s(double mass_kg, double stiffness, double speed_m_s) {
  return 2.94328 * hertz_deflection_m(mass_kg, stiffness, speed_m_s) / speed_m_s;
}

double NormalLaw::deflection_estimate_m(double mass_kg, double speed_m_s) const {
  return speed_m_s * duration_estimate_s(mass_kg, speed_m_s) / kPi;
}

namespace {

// P = k delta^p + b delta' (source Eqs 3.6, 3.10 with p = 1; Eqs 4.8, 4.9 with p = 3/2). Below zero
// deflection the spring continues as an odd function, so that an integration step may overshoot.
class SpringDamper final : public NormalLaw {
 public:
  SpringDamper(bool hertz, const ContactParameters& contact, double radius_m)
      : hertz_(hertz),
        stiffness_(contact.stiffness),
        damping_(contact.damping_n_s_per_m),
        radius_(radius_m),
        ending_(contact.restitution_damping),
        damped_restitution_(ending_ != RestitutionDamping::kNone) {}

  double spring_n(double deflection_m, const NormalMemory&) const override {
    const double force = stiffness_ * deflection_m;
    return hertz_ ? force * std::sqrt(std::abs(deflection_m)) : force;
  }

  double damper_n(double, double rate_m_s, const NormalMemory& memory) const override {
    return memory.compressing || damped_restitution_ ? damping_ * rate_m_s : 0.0;
  }

  double work_j(double deflection_m, const NormalMemory& memory) const override {
    return spring_n(deflection_m, memory) * deflection_m / (hertz_ ? 2.5 : 2.0);
  }

  double force_growth(double deflection_m, double rate_m_s, double acceleration) const override {
    const double slope = hertz_ ? 1.5 * stiffness_ * std::sqrt(std::abs(deflection_m)) : stiffness_;
    return slope * rate_m_s + damping_ * acceleration;
  }

  Slopes slopes(double deflection_m, const NormalMemory& memory) const override {
    Slopes slopes;
    slopes.damper = damper_n(deflection_m, 1, memory);
    slopes.spring = stiffness_;
    if (!hertz_) return slopes;
    const double root = std::sqrt(std::abs(deflection_m));
    slopes.spring *= 1.5 * root;
    if (root > 0) slopes.spring_turn = 0.75 * stiffness_ / root;
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
    if (!hertz_) return kPi * std::sqrt(mass_kg / stiffness_);
    return hertz_duration_s(mass_kg, stiffness_, speed_m_s);
  }

  double deflection_estimate_m(double mass_kg, double speed_m_s) const override {
    if (!hertz_) return speed_m_s * std::sqrt(mass_kg / stiffness_);
    return hertz_deflection_m(mass_kg, stiffness_, speed_m_s);
  }

 private:
  bool hertz_;
  double stiffness_, damping_, radius_;
  RestitutionDamping ending_;
  bool damped_restitution_;
};

}  // namespace

std::unique_ptr<NormalLaw> make_normal_law(const ImpactJob& job) {
  switch (job.normal) {
    case NormalModel::kLinearSpringDamper:
      return std::make_unique<SpringDamper>(false, job.contact, job.contact_radius_m());
    case NormalModel::kHertzDamper:
      return std::make_unique<SpringDamper>(true, job.contact, job.contact_radius_m());
    case NormalModel::kTsuji:
    case NormalModel::kKuwabaraKono:
    case NormalModel::kHuntCrossley:
      return make_damped_hertz(job.normal, job.contact, job.contact_radius_m(), job.body.mass_kg);
    case NormalModel::kWaltonBraun:
      return make_walton_braun(job.contact, job.contact_radius_m());
    case NormalModel::kJkr:
      return make_jkr(job.contact, job.contact_radius_m());
    default:
      return make_elastoplastic_law(job.normal, job.contact, job.contact_radius_m());
  }
}

}  // namespace impactdic::sim::contact
