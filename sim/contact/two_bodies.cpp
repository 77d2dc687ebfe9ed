#include "sim/contact/two_bodies.h"

#include <cmath>
#include <utility>

namespace impactdic::sim::contact {
namespace {

double kinetic_j(const ImpactBody& body, const BodyState& s) {
  return 0.5 * body.mass_kg * (s.vt_m_s * s.vt_m_s + s.vn_m_s * s.vn_m_s + s.vb_m_s * s.vb_m_s) +
         0.5 * body.inertia() *
             (s.omega_rad_s * s.omega_rad_s + s.omega_t_rad_s * s.omega_t_rad_s +
              s.omega_n_rad_s * s.omega_n_rad_s);
}

ImpactState of_state(const BodyState& s) {
  ImpactState x{};
  x[kQt] = s.qt_m, x[kQn] = s.qn_m, x[kQb] = s.qb_m, x[kAngle] = s.angle_rad;
  x[kVt] = s.vt_m_s, x[kVn] = s.vn_m_s, x[kVb] = s.vb_m_s;
  x[kOmega] = s.omega_rad_s, x[kOmegaT] = s.omega_t_rad_s, x[kOmegaN] = s.omega_n_rad_s;
  return x;
}

// The motion of both balls at one moment, from that of the body which stands for them.
class BothBodies {
 public:
  explicit BothBodies(const ImpactJob& job)
      : job_(job),
        numbers_(job),
        gravity_t_(numbers_.gravity_t()),
        gravity_n_(numbers_.gravity_n()) {}

  BodyState state(double time_s, const BodyState& r, int side) const {
    const ImpactState x = state_of_ball(numbers_, time_s, of_state(r), side);
    BodyState s;
    s.qt_m = x[kQt], s.qn_m = x[kQn], s.qb_m = x[kQb], s.angle_rad = x[kAngle];
    s.vt_m_s = x[kVt], s.vn_m_s = x[kVn], s.vb_m_s = x[kVb];
    s.omega_rad_s = x[kOmega], s.omega_t_rad_s = x[kOmegaT], s.omega_n_rad_s = x[kOmegaN];
    return s;
  }

  // The energies of both, and what the terms of the contact then leave over.
  EnergyLedger ledger(EnergyLedger energy, const BodyState& first, const BodyState& second) const {
    const ImpactBody &a = job_.body, &b = job_.other->body;
    energy.kinetic_start_j =
        kinetic_j(a, state_of(job_.initial)) + kinetic_j(b, state_of(job_.other->initial));
    energy.kinetic_j = kinetic_j(a, first) + kinetic_j(b, second);
    const double fallen_t = a.mass_kg * first.qt_m + b.mass_kg * second.qt_m;
    const double fallen_n = a.mass_kg * (first.qn_m - job_.initial.gap_m) + b.mass_kg * second.qn_m;
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
  JobNumbers<double> numbers_;
  double gravity_t_, gravity_n_;
};

}  // namespace

template <typename Real>
ImpactStateOf<Real> state_of_ball(const JobNumbers<Real>& numbers, const Real& time_s,
                                  const ImpactStateOf<Real>& r, int side) {
  const JobNumbers<Real> one = numbers.relative();
  const Real gravity_t = numbers.gravity_t(), gravity_n = numbers.gravity_n();
  const BodyNumbers<Real>& body = side > 0 ? numbers.body : numbers.other;
  const MotionNumbers<Real>& from = side > 0 ? numbers.initial : numbers.other_initial;
  const MotionNumbers<Real>& start = one.initial;
  const Real mass = numbers.contact_mass_kg();
  const Real share = static_cast<double>(side) * mass / body.mass_kg;
  // What the contact has done so far: to velocities, and to places by their integral.
  const Real dvt = r[kVt] - start.vt_m_s, dvn = r[kVn] - start.vn_m_s, dvb = r[kVb] - start.vb_m_s;
  const Real dqt = r[kQt] - start.vt_m_s * time_s, dqb = r[kQb] - start.vb_m_s * time_s;
  const Real dqn = r[kQn] - start.gap_m - start.vn_m_s * time_s;
  const Real spin = mass * body.radius_m() / body.inertia();
  const Real fallen = time_s * time_s / 2.0;
  ImpactStateOf<Real> s{};
  s[kVt] = from.vt_m_s + share * dvt + gravity_t * time_s;
  s[kVn] = from.vn_m_s + share * dvn + gravity_n * time_s;
  s[kVb] = from.vb_m_s + share * dvb;
  s[kQt] = from.vt_m_s * time_s + share * dqt + gravity_t * fallen;
  s[kQn] =
      (side > 0 ? start.gap_m : Real(0)) + from.vn_m_s * time_s + share * dqn + gravity_n * fallen;
  s[kQb] = from.vb_m_s * time_s + share * dqb;
  s[kOmega] = from.omega_rad_s + spin * dvt;
  s[kOmegaT] = from.omega_t_rad_s - spin * dvb;
  s[kOmegaN] = from.omega_n_rad_s;
  s[kAngle] = from.omega_rad_s * time_s + spin * dqt;
  return s;
}

template ImpactState state_of_ball(const JobNumbers<double>&, const double&, const ImpactState&,
                                   int);
template ImpactStateOf<Sensitive> state_of_ball(const JobNumbers<Sensitive>&, const Sensitive&,
                                                const ImpactStateOf<Sensitive>&, int);

ImpactJob relative_job(const ImpactJob& job) {
  const JobNumbers<double> one = JobNumbers<double>(job).relative();
  ImpactJob relative = job;
  relative.other.reset();
  relative.gravity_m_s2 = one.gravity_m_s2;
  relative.body.shape = one.body.shape;
  relative.body.mass_kg = one.body.mass_kg;
  relative.body.diameter_m = one.body.diameter_m;
  relative.body.inertia_kg_m2 = one.body.given_inertia_kg_m2;
  relative.initial.vt_m_s = one.initial.vt_m_s;
  relative.initial.vn_m_s = one.initial.vn_m_s;
  relative.initial.vb_m_s = one.initial.vb_m_s;
  relative.initial.omega_rad_s = one.initial.omega_rad_s;
  relative.initial.omega_t_rad_s = one.initial.omega_t_rad_s;
  relative.initial.omega_n_rad_s = one.initial.omega_n_rad_s;
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
