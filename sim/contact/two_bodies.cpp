#include "sim/contact/two_bodies.h"

#include <impactdic/units.h>

#include <cmath>
#include <utility>

namespace impactdic::sim::contact {
namespace {

double leverage(const ImpactBody& body) {  // R^2/I
  return body.radius_m() * body.radius_m() / body.inertia();
}

double kinetic_j(const ImpactBody& body, const BodyState& s) {
  return 0.5 * body.mass_kg * (s.vt_m_s * s.vt_m_s + s.vn_m_s * s.vn_m_s + s.vb_m_s * s.vb_m_s) +
         0.5 * body.inertia() *
             (s.omega_rad_s * s.omega_rad_s + s.omega_t_rad_s * s.omega_t_rad_s +
              s.omega_n_rad_s * s.omega_n_rad_s);
}

// The motion of both balls at one moment, from that of the body which stands for them.
class BothBodies {
 public:
  explicit BothBodies(const ImpactJob& job)
      : job_(job),
        relative_(relative_job(job)),
        mass_(relative_.body.mass_kg),
        gravity_t_(-job.gravity_m_s2 * std::sin(job.surface_angle_deg * kRadPerDeg)),
        gravity_n_(-job.gravity_m_s2 * std::cos(job.surface_angle_deg * kRadPerDeg)) {}

  // `side`: 1 for the ball above the plane of contact, -1 for the one below.
  BodyState state(double time_s, const BodyState& r, int side) const {
    const ImpactBody& body = side > 0 ? job_.body : job_.other->body;
    const InitialMotion& from = side > 0 ? job_.initial : job_.other->initial;
    const InitialMotion& start = relative_.initial;
    const double share = side * mass_ / body.mass_kg;
    // What the contact has done so far: to velocities, and to places by their integral.
    const double dvt = r.vt_m_s - start.vt_m_s, dvn = r.vn_m_s - start.vn_m_s;
    const double dvb = r.vb_m_s - start.vb_m_s;
    const double dqt = r.qt_m - start.vt_m_s * time_s, dqb = r.qb_m - start.vb_m_s * time_s;
    const double dqn = r.qn_m - start.gap_m - start.vn_m_s * time_s;
    const double spin = mass_ * body.radius_m() / body.inertia();
    const double fallen = time_s * time_s / 2;
    BodyState s;
    s.vt_m_s = from.vt_m_s + share * dvt + gravity_t_ * time_s;
    s.vn_m_s = from.vn_m_s + share * dvn + gravity_n_ * time_s;
    s.vb_m_s = from.vb_m_s + share * dvb;
    s.qt_m = from.vt_m_s * time_s + share * dqt + gravity_t_ * fallen;
    s.qn_m =
        (side > 0 ? start.gap_m : 0.0) + from.vn_m_s * time_s + share * dqn + gravity_n_ * fallen;
    s.qb_m = from.vb_m_s * time_s + share * dqb;
    s.omega_rad_s = from.omega_rad_s + spin * dvt;
    s.omega_t_rad_s = from.omega_t_rad_s - spin * dvb;
    s.omega_n_rad_s = from.omega_n_rad_s;
    s.angle_rad = from.omega_rad_s * time_s + spin * dqt;
    return s;
  }

  // The energies of both, and what the terms of the contact then leave over.
  EnergyLedger ledger(EnergyLedger energy, const BodyState& first, const BodyState& second) const {
    const ImpactBody &a = job_.body, &b = job_.other->body;
    energy.kinetic_start_j =
        kinetic_j(a, state_of(job_.initial)) + kinetic_j(b, state_of(job_.other->initial));
    energy.kinetic_j = kinetic_j(a, first) + kinetic_j(b, second);
    const double fallen_t = a.mass_kg * first.qt_m + b.mass_kg * second.qt_m;
    const double fallen_n =
        a.mass_kg * (first.qn_m - relative_.initial.gap_m) + b.mass_kg * second.qn_m;
    energy.gravity_j = gravity_t_ * fallen_t + gravity_n_ * fallen_n;
    energy.residual_j = energy.kinetic_start_j + energy.gravity_j - energy.kinetic_j -
                        energy.normal_elastic_j - energy.damping_j - energy.tangential_elastic_j -
                        energy.slip_j - energy.plastic_j;
    return energy;
  }

 private:
  static BodyState state_of(const InitialMotion& m) {
    BodyState s;
    s.vt_m_s = m.vt_m_s, s.vn_m_s = m.vn_m_s, s.vb_m_s = m.vb_m_s;
    s.omega_rad_s = m.omega_rad_s;
    s.omega_t_rad_s = m.omega_t_rad_s, s.omega_n_rad_s = m.omega_n_rad_s;
    return s;
  }

  const ImpactJob& job_;
  ImpactJob relative_;
  double mass_, gravity_t_, gravity_n_;
};

}  // namespace

ImpactJob relative_job(const ImpactJob& job) {
  const ImpactBody &a = job.body, &b = job.other->body;
  const InitialMotion &from = job.initial, &other = job.other->initial;
  ImpactJob relative = job;
  relative.other.reset();
  relative.gravity_m_s2 = 0;
  const double radius = job.contact_radius_m();
  relative.body.shape = BodyShape::kOther;
  relative.body.mass_kg = job.contact_mass_kg();
  relative.body.diameter_m = 2 * radius;
  relative.body.inertia_kg_m2 = radius * radius / (leverage(a) + leverage(b));
  const auto rolled = [&](double first, double second) {
    return (a.radius_m() * first + b.radius_m() * second) / radius;
  };
  relative.initial.vt_m_s = from.vt_m_s - other.vt_m_s;
  relative.initial.vn_m_s = from.vn_m_s - other.vn_m_s;
  relative.initial.vb_m_s = from.vb_m_s - other.vb_m_s;
  relative.initial.omega_rad_s = rolled(from.omega_rad_s, other.omega_rad_s);
  relative.initial.omega_t_rad_s = rolled(from.omega_t_rad_s, other.omega_t_rad_s);
  relative.initial.omega_n_rad_s = from.omega_n_rad_s - other.omega_n_rad_s;
  return relative;
}

ImpactResult of_two_bodies(const ImpactJob& job, ImpactResult relative) {
  const BothBodies both(job);
  ImpactResult result = std::move(relative);
  const double end_s = result.end_s;
  result.other_start = both.state(0, result.start, -1);
  result.other_final = both.state(end_s, result.final, -1);
  const BodyState final = both.state(end_s, result.final, 1);
  result.start = both.state(0, result.start, 1);
  result.final = final;
  result.energy = both.ledger(result.energy, result.final, result.other_final);
  for (TrajectoryPoint& point : result.trajectory) {
    point.other = both.state(point.time_s, point.state, -1);
    point.state = both.state(point.time_s, point.state, 1);
    point.energy = both.ledger(point.energy, point.state, point.other);
  }
  return result;
}

}  // namespace impactdic::sim::contact
