#include "sim/contact/numbers/numbers.h"

#include <impactdic/units.h>

#include <algorithm>

namespace impactdic::sim::contact {
namespace {

template <typename Real>
BodyNumbers<Real> numbers(const ImpactBody& body) {
  return {body.shape, Real(body.mass_kg), Real(body.diameter_m), Real(body.length_m),
          Real(body.inertia_kg_m2)};
}

template <typename Real>
MotionNumbers<Real> numbers(const InitialMotion& m) {
  return {Real(m.vt_m_s),        Real(m.vn_m_s),        Real(m.vb_m_s), Real(m.omega_rad_s),
          Real(m.omega_t_rad_s), Real(m.omega_n_rad_s), Real(m.gap_m),  Real(m.angle_deg)};
}

template <typename Real>
Real leverage(const BodyNumbers<Real>& body) {  // R^2/I
  return body.radius_m() * body.radius_m() / body.inertia();
}

}  // namespace

template <typename Real>
Real BodyNumbers<Real>::inertia() const {
  if (given_inertia_kg_m2 > 0) return given_inertia_kg_m2;
  const Real radius = radius_m();
  switch (shape) {
    case BodyShape::kHollowSphere:
      return 2.0 / 3.0 * mass_kg * radius * radius;
    case BodyShape::kSolidSphere:
      return 0.4 * mass_kg * radius * radius;
    case BodyShape::kRod:
      return mass_kg * length_m * length_m / 12.0;
    case BodyShape::kOther:
      break;
  }
  return Real(0);
}

template <typename Real>
JobNumbers<Real>::JobNumbers(const ImpactJob& job)
    : body(numbers<Real>(job.body)),
      initial(numbers<Real>(job.initial)),
      two_balls(job.other.has_value()),
      surface_angle_deg(job.surface_angle_deg),
      surface_radius_m(job.surface_radius_m),
      gravity_m_s2(job.gravity_m_s2),
      air_density_kg_m3(job.air.density_kg_m3),
      drag_coefficient(job.air.drag_coefficient),
      lift_coefficient(job.air.lift_coefficient) {
  const ContactParameters& c = job.contact;
  contact = {Real(c.stiffness),
             Real(c.damping_n_s_per_m),
             Real(c.damping_factor),
             Real(c.dissipation_s),
             Real(c.damping_s_per_m),
             Real(c.friction_kinetic),
             Real(c.friction_static),
             Real(c.friction_speed_m_s),
             Real(c.poisson),
             Real(c.reduced_modulus_pa),
             Real(c.yield_strength_pa),
             Real(c.adhesion_j_per_m2),
             Real(c.unloading_stiffness_n_per_m),
             Real(c.unloading_hardening_per_m),
             Real(c.tangential_stiffness_n_per_m),
             Real(c.rolling_friction),
             Real(c.spinning_friction)};
  if (job.shell) {
    has_shell = true;
    shell = {Real(job.shell->stiffness_n_per_m), Real(job.shell->damping_n_s_per_m),
             Real(job.shell->flat_fraction)};
  }
  if (!two_balls) return;
  other = numbers<Real>(job.other->body);
  other_initial = numbers<Real>(job.other->initial);
}

template <typename Real>
Real JobNumbers<Real>::contact_radius_m() const {
  const Real radius = body.radius_m();
  const Real across = two_balls ? other.radius_m() : surface_radius_m;
  return across == 0 ? radius : 1.0 / (1.0 / radius + 1.0 / across);
}

template <typename Real>
Real JobNumbers<Real>::contact_mass_kg() const {
  if (!two_balls) return body.mass_kg;
  return body.mass_kg * other.mass_kg / (body.mass_kg + other.mass_kg);
}

template <typename Real>
Real JobNumbers<Real>::gravity_t() const {
  return -gravity_m_s2 * sin(surface_angle_deg * kRadPerDeg);
}

template <typename Real>
Real JobNumbers<Real>::gravity_n() const {
  return -gravity_m_s2 * cos(surface_angle_deg * kRadPerDeg);
}

template <typename Real>
JobNumbers<Real> JobNumbers<Real>::relative() const {
  JobNumbers one = *this;
  one.two_balls = false;
  one.surface_radius_m = one.gravity_m_s2 = Real(0);
  const Real radius = contact_radius_m();
  one.body.shape = BodyShape::kOther;
  one.body.mass_kg = contact_mass_kg();
  one.body.diameter_m = 2.0 * radius;
  one.body.given_inertia_kg_m2 = radius * radius / (leverage(body) + leverage(other));
  const auto rolled = [&](const Real& first, const Real& second) -> Real {
    return (body.radius_m() * first + other.radius_m() * second) / radius;
  };
  const MotionNumbers<Real>&from = initial, &to = other_initial;
  one.initial.vt_m_s = from.vt_m_s - to.vt_m_s;
  one.initial.vn_m_s = from.vn_m_s - to.vn_m_s;
  one.initial.vb_m_s = from.vb_m_s - to.vb_m_s;
  one.initial.omega_rad_s = rolled(from.omega_rad_s, to.omega_rad_s);
  one.initial.omega_t_rad_s = rolled(from.omega_t_rad_s, to.omega_t_rad_s);
  one.initial.omega_n_rad_s = from.omega_n_rad_s - to.omega_n_rad_s;
  return one;
}

namespace {

// Collects keys and numbers; `scale` 0: the number's own size.
template <typename Real>
class List {
 public:
  void add(const std::string& key, Real& number, double scale = 0) {
    const double size = std::abs(value_of(number));
    entries.push_back({key, &number, std::max(size, scale) > 0 ? std::max(size, scale) : 1});
  }
  std::vector<NumberOfJob<Real>> entries;
};

template <typename Real>
void add_body(List<Real>& list, const std::string& table, BodyNumbers<Real>& body) {
  list.add(table + ".mass_kg", body.mass_kg);
  list.add(table + ".diameter_m", body.diameter_m);
  if (body.given_inertia_kg_m2 > 0) {
    list.add(table + ".inertia_kg_m2", body.given_inertia_kg_m2);
  }
  if (body.shape == BodyShape::kRod) list.add(table + ".length_m", body.length_m);
}

template <typename Real>
void add_motion(List<Real>& list, const std::string& table, const BodyNumbers<Real>& body,
                MotionNumbers<Real>& m, double speed) {
  const bool rod = body.shape == BodyShape::kRod;
  const double spin = speed / value_of(rod ? body.length_m : body.radius_m());
  list.add(table + ".vt_m_s", m.vt_m_s, speed);
  list.add(table + ".vn_m_s", m.vn_m_s, speed);
  list.add(table + ".omega_rad_s", m.omega_rad_s, spin);
  if (rod) return list.add(table + ".angle_deg", m.angle_deg, 57);
  list.add(table + ".vb_m_s", m.vb_m_s, speed);
  list.add(table + ".omega_t_rad_s", m.omega_t_rad_s, spin);
  list.add(table + ".omega_n_rad_s", m.omega_n_rad_s, spin);
}

template <typename Real>
void add_normal(List<Real>& list, const ImpactJob& job, ContactNumbers<Real>& c) {
  const NormalModel law = job.normal;
  const auto key = [](std::string_view name) { return "contact." + std::string(name); };
  if (!stiffness_key(law).empty()) {
    list.add(key(stiffness_key(law)), c.stiffness);
  } else {
    list.add("contact.reduced_modulus_pa", c.reduced_modulus_pa);
  }
  const double critical = 1;  // dampers are no more than a few of these
  switch (law) {
    case NormalModel::kLinearSpringDamper:
    case NormalModel::kHertzDamper:
      return list.add(key(damping_key(law)), c.damping_n_s_per_m,
                      1e-3 * std::sqrt(job.contact.stiffness * job.body.mass_kg));
    case NormalModel::kTsuji:
      return list.add(key(damping_key(law)), c.damping_factor, critical);
    case NormalModel::kKuwabaraKono:
      return list.add(key(damping_key(law)), c.dissipation_s, 1e-6);
    case NormalModel::kHuntCrossley:
      return list.add(key(damping_key(law)), c.damping_s_per_m, 1e-3);
    case NormalModel::kWaltonBraun:
      list.add("contact.unloading_stiffness_n_per_m", c.unloading_stiffness_n_per_m);
      return list.add("contact.unloading_hardening_per_m", c.unloading_hardening_per_m, 1);
    case NormalModel::kJkr:
      return list.add("contact.adhesion_j_m2", c.adhesion_j_per_m2, 1e-3);
    default:
      return list.add("contact.yield_strength_pa", c.yield_strength_pa);
  }
}

template <typename Real>
void add_shell(List<Real>& list, const ImpactJob& job, ShellNumbers<Real>& shell) {
  if (!job.shell) return;
  list.add("shell.stiffness_n_per_m", shell.stiffness_n_per_m);
  list.add("shell.damping_n_s_per_m", shell.damping_n_s_per_m,
           1e-3 * std::sqrt(job.shell->stiffness_n_per_m * job.body.mass_kg));
  list.add("shell.flat_fraction", shell.flat_fraction);
}

template <typename Real>
void add_friction(List<Real>& list, const ImpactJob& job, ContactNumbers<Real>& c) {
  const FrictionModel law = job.friction;
  if (law != FrictionModel::kNone) list.add("contact.friction_kinetic", c.friction_kinetic, 0.1);
  const bool two = law == FrictionModel::kThreePhase || law == FrictionModel::kGripSlip ||
                   law == FrictionModel::kSpeedDependent;
  if (two) list.add("contact.friction_static", c.friction_static, 0.1);
  if (law == FrictionModel::kSpeedDependent) {
    list.add("contact.friction_speed_m_s", c.friction_speed_m_s);
  }
  if (remembers_slip(law) && !slips_partially(law)) {
    list.add("contact.tangential_stiffness_n_per_m", c.tangential_stiffness_n_per_m);
  }
  const bool plastic = job.normal == NormalModel::kJacksonGreen ||
                       job.normal == NormalModel::kKogutEtsion ||
                       job.normal == NormalModel::kThornton;
  if (slips_partially(law) || plastic) list.add("contact.poisson", c.poisson, 0.1);
  if (job.body.shape == BodyShape::kRod || job.other) return;
  list.add("contact.rolling_friction", c.rolling_friction, 0.01);
  list.add("contact.spinning_friction", c.spinning_friction, 0.1);
}

}  // namespace

template <typename Real>
std::vector<NumberOfJob<Real>> numbers_of(const ImpactJob& job, JobNumbers<Real>& n) {
  List<Real> list;
  const InitialMotion& m = job.initial;
  const bool rod = job.body.shape == BodyShape::kRod;
  const double speed = std::max({std::hypot(m.vt_m_s, m.vn_m_s, m.vb_m_s),
                                 job.other ? std::abs(job.other->initial.vn_m_s) : 0.0});
  add_body(list, "body", n.body);
  if (n.two_balls) add_body(list, "other", n.other);
  add_motion(list, "initial", n.body, n.initial, speed);
  if (!rod) list.add("initial.gap_m", n.initial.gap_m, job.body.radius_m());
  if (n.two_balls) add_motion(list, "other", n.other, n.other_initial, speed);
  add_normal(list, job, n.contact);
  add_friction(list, job, n.contact);
  add_shell(list, job, n.shell);
  list.add("surface.angle_deg", n.surface_angle_deg, 57);
  if (job.surface_radius_m != 0) list.add("surface.radius_m", n.surface_radius_m);
  list.add("environment.gravity_m_s2", n.gravity_m_s2, 10);
  if (job.air.act()) {
    list.add("air.density_kg_m3", n.air_density_kg_m3);
    list.add("air.drag_coefficient", n.drag_coefficient, 0.1);
    list.add("air.lift_coefficient", n.lift_coefficient, 0.1);
  }
  return std::move(list.entries);
}

template struct BodyNumbers<double>;
template struct BodyNumbers<Sensitive>;
template struct JobNumbers<double>;
template struct JobNumbers<Sensitive>;
template std::vector<NumberOfJob<double>> numbers_of(const ImpactJob&, JobNumbers<double>&);
template std::vector<NumberOfJob<Sensitive>> numbers_of(const ImpactJob&, JobNumbers<Sensitive>&);

}  // namespace impactdic::sim::contact
