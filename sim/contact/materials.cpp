// What the laws of contact take from materials.
#include <impactdic/error.h>
#include <impactdic/impact_model.h>

#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <string>

#include "sim/contact/impact.h"

namespace impactdic {
namespace {

void require_elastic(const ElasticMaterial& material, const std::string& table) {
  if (!(material.young_pa > 0) || !std::isfinite(material.young_pa)) {
    throw InvalidArgument("must be positive", table + ".young_pa");
  }
  if (!(material.poisson >= 0 && material.poisson <= 0.5)) {
    throw InvalidArgument("must be from 0 to 0.5", table + ".poisson");
  }
}

// The restitution of the job's normal law with this damping, in a normal impact without weight.
double restitution_of(ImpactJob job, double damping, double speed_m_s) {
  job.contact.set_damping(job.normal, damping);
  job.friction = FrictionModel::kNone;
  job.body.mass_kg = job.contact_mass_kg();
  job.body.shape = BodyShape::kSolidSphere;
  job.body.inertia_kg_m2 = 0;
  job.other.reset();
  job.shell.reset();
  job.initial = {};
  job.initial.vn_m_s = -speed_m_s;
  job.gravity_m_s2 = 0;
  job.solver = {};
  return sim::contact::simulate_impact(job).restitution;
}

// Where the damper takes about as much as the spring.
double strong_damping(const ImpactJob& job, double speed_m_s) {
  const double mass = job.contact_mass_kg();
  const double deflection =
      has_hertz_spring(job.normal)
          ? std::pow(1.25 * mass * speed_m_s * speed_m_s / job.contact.stiffness, 0.4)
          : speed_m_s * std::sqrt(mass / job.contact.stiffness);
  switch (job.normal) {
    case NormalModel::kTsuji:
      return 1;
    case NormalModel::kKuwabaraKono:
      return deflection / speed_m_s;
    case NormalModel::kHuntCrossley:
      return 1 / speed_m_s;
    default:
      return mass * speed_m_s / deflection;
  }
}

// The restitution falls as the damping grows.
double damping_for(const ImpactJob& job, double restitution, double speed_m_s) {
  if (restitution == 1) return 0;
  const auto excess = [&](double damping) {
    return restitution_of(job, damping, speed_m_s) - restitution;
  };
  double high = strong_damping(job, speed_m_s);
  double low = 0, low_value = 1 - restitution, high_value = excess(high);
  for (int i = 0; i < 60 && high_value > 0; ++i) {
    low = high, low_value = high_value;
    high *= 2;
    high_value = excess(high);
  }
  if (high_value > 0) throw InvalidArgument("is too small for a damper", "contact.restitution");
  std::uintmax_t iterations = 200;
  const auto close = [](double a, double b) { return std::abs(b - a) <= 1e-13 * std::abs(b); };
  const auto [a, b] = boost::math::tools::toms748_solve(excess, low, high, low_value, high_value,
                                                        close, iterations);
  return (a + b) / 2;
}

}  // namespace

double reduced_modulus_pa(const ElasticMaterial& a, const ElasticMaterial& b) {
  return 1 / ((1 - a.poisson * a.poisson) / a.young_pa + (1 - b.poisson * b.poisson) / b.young_pa);
}

double reduced_shear_modulus_pa(const ElasticMaterial& a, const ElasticMaterial& b) {
  return 1 / ((2 - a.poisson) / (4 * a.shear_pa()) + (2 - b.poisson) / (4 * b.shear_pa()));
}

double equivalent_poisson(const ElasticMaterial& a, const ElasticMaterial& b) {
  if (a.poisson == b.poisson) return a.poisson;
  const double ratio = reduced_shear_modulus_pa(a, b) / reduced_modulus_pa(a, b);
  return 2 * (1 - ratio) / (2 - ratio);
}

double hertz_stiffness(double reduced_modulus_pa, double contact_radius_m) {
  return 4.0 / 3.0 * reduced_modulus_pa * std::sqrt(contact_radius_m);
}

double ImpactJob::contact_radius_m() const {
  const double radius = body.radius_m();
  const double across = other ? other->body.radius_m() : surface_radius_m;
  return across == 0 ? radius : 1 / (1 / radius + 1 / across);
}

double ImpactJob::contact_mass_kg() const {
  if (!other) return body.mass_kg;
  return body.mass_kg * other->body.mass_kg / (body.mass_kg + other->body.mass_kg);
}

void ImpactJob::take_materials(const ContactMaterials& from) {
  if (!(contact_radius_m() > 0)) {
    throw InvalidArgument("a hollow must be wider than the ball", "surface.radius_m");
  }
  if (from.body.young_pa != 0 || from.surface.young_pa != 0) {
    require_elastic(from.body, "body");
    require_elastic(from.surface, other ? "other" : "surface");
    contact.reduced_modulus_pa = impactdic::reduced_modulus_pa(from.body, from.surface);
    if (slips_partially(friction)) {
      contact.poisson = equivalent_poisson(from.body, from.surface);
    }
    if (has_hertz_spring(normal)) {
      contact.stiffness = hertz_stiffness(contact.reduced_modulus_pa, contact_radius_m());
    }
  }
  materials = from;
  if (from.restitution == 0) return;
  const bool damped = !damping_key(normal).empty();
  if (!damped && normal != NormalModel::kWaltonBraun) {
    throw InvalidArgument("this normal law has no damper", "contact.restitution");
  }
  if (!(from.restitution > 0 && from.restitution <= 1)) {
    throw InvalidArgument("must be above 0 and at most 1", "contact.restitution");
  }
  const bool by_speed = has_hertz_spring(normal) && normal != NormalModel::kTsuji;
  if (by_speed && !(from.restitution_speed_m_s > 0 && std::isfinite(from.restitution_speed_m_s))) {
    throw InvalidArgument("must be positive", "contact.restitution_speed_m_s");
  }
  if (!(contact.stiffness > 0)) {
    throw InvalidArgument("a restitution needs a stiffness", "contact.restitution");
  }
  body.validate();
  if (!damped) {  // e = sqrt(k1/k2), Walton and Braun 1986
    if (contact.unloading_hardening_per_m != 0) {
      throw InvalidArgument("depends on the speed where the contact hardens", "contact.restitution",
                            "unloading_hardening_per_m says it already");
    }
    contact.unloading_stiffness_n_per_m = contact.stiffness / (from.restitution * from.restitution);
    return;
  }
  const double speed = by_speed ? from.restitution_speed_m_s : 1;
  contact.set_damping(normal, damping_for(*this, from.restitution, speed));
}

}  // namespace impactdic
